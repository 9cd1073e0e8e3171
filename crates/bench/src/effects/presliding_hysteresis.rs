//! Friction reverses over a distance instead of at once.
//!
//! Dry friction has `w` with `w' = |v| (s - w)/d_0` in place of the sign `s = tanh(v/v_r)`:
//! bristles that bend before they slip (Dahl 1968, exponent 1; Bliman and Sorine). This is a
//! rate-independent hysteresis over position. Parameter: `distance_m` at the friction radius, 0 to
//! 5 mm with a prior of 0.1 mm; on an axis 0 to 1 m with a prior of a tenth of half the stroke. As
//! it goes to 0, `w` becomes `s` and the effect vanishes. At standstill `w` keeps the last force,
//! while the nominal sign goes to 0: in a log with standstills the effect does not vanish with
//! `d_0`. Refused together with a friction law that has bristles (`dahl`, `lugre`). In a log: after
//! each reversal friction grows over the distance; force over position shows a rounded loop.
//! Confounded with play (which also delays friction by a distance), with a delay of the friction's
//! sensor, and with breakaway or Stribeck friction of the opposite sign.

use super::kind::{Action, Apply, EffectKind, EffectParameter, Measure};
use crate::description::Plant;
use crate::signals::Channel;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "presliding-hysteresis",
    summary: "Friction reverses over a distance instead of at once.",
    shows_in: Some(Channel::FrictionTorque),
    confounded_with: &["breakaway", "drive-lag", "fork-backlash", "sensor-delay", "stribeck-friction"],
    actions: &[
        Action {
            plants: &[Plant::Planar],
            parameters: &[EffectParameter::size("distance_m", "m", 1e-4, [0.0, 5e-3], 1e-4)],
            apply: Apply::Transmission(|bench, parameter| {
                bench.extension.presliding_distance_m += parameter("distance_m")
            }),
        },
        Action {
            plants: Plant::AXES,
            // An axis measures its effort together with its friction, so a micrometre is visible.
            parameters: &[
                EffectParameter::size("distance_m", "m", 2e-5, [0.0, 1.0], 0.1).in_log(Measure::Distance)
            ],
            apply: Apply::Axis(|rig, parameter| {
                rig.extension.presliding_distance_m += parameter("distance_m")
            }),
        },
    ],
    ..EffectKind::DEFAULT
};
