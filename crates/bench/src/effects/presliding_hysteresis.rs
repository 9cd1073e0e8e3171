//! Friction turns round over a distance instead of at once.
//!
//! In place of the sign `s = tanh(v/v_r)` dry friction has `w` with `w' = |v| (s - w)/d_0`: bristles that bend before they
//! slip (Dahl 1968, exponent 1; Bliman and Sorine). Rate-independent hysteresis in the position. Parameter:
//! `distance_m`, 0 to 5 mm at the friction radius, prior 0.1 mm. As it goes to 0, `w` becomes `s` and the effect is gone.
//! At rest `w` holds the last force, where the nominal sign lets go: in a log with rests the effect does not fade with `d_0`.
//! Refused beside a friction law that has bristles of its own (`dahl`, `lugre`).
//! In a log: after each reversal friction grows over the distance; force over position shows a rounded loop.
//! Confounded with play (which also delays friction by a distance), with a delay of the friction's sensor, and with
//! breakaway or Stribeck's fall of the other sign.

use super::kind::{EffectKind, EffectParameter, Guess, Plant};
use crate::channel::Channel;
use crate::description::Bench;

const TRANSMISSION: &[EffectParameter] = &[EffectParameter::size("distance_m", "m", 1e-4, [0.0, 5e-3], 1e-4)];
// The effort of an axis is measured beside its friction: a micrometre already shows.
const AXIS: &[EffectParameter] = &[EffectParameter::size("distance_m", "m", 3e-6, [0.0, 5e-3], 1e-4)];

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "presliding-hysteresis",
    summary: "Friction turns round over a distance instead of at once.",
    per_channel: false,
    plants: &[Plant::Planar, Plant::Rotary, Plant::Linear],
    transmission: TRANSMISSION,
    axis: AXIS,
    shows_in: Some(Channel::FrictionTorque),
    confounded_with: &["breakaway", "drive-lag", "fork-backlash", "sensor-delay", "stribeck-friction"],
    guess: Guess::Defaults,
    apply: |bench, _, parameter| match bench {
        Bench::Transmission(bench) => bench.extension.presliding_distance_m += parameter("distance_m"),
        Bench::FrictionRig(rig) => rig.extension.presliding_distance_m += parameter("distance_m"),
    },
};
