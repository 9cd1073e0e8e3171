//! Dry friction differs between the two directions.
//!
//! Bearing: the coefficient times `1 + a s`, `s = tanh(v/v_r)` (`asymmetry`, -1 to 1, prior 0.1).
//! Axis: an effort `a s^2/2` in either direction, so that friction differs by `asymmetry_effort`
//! between forward and backward, in N or N m (within 1e9, prior 3 times the log's rms effort).
//! Direction-dependent Coulomb friction (Armstrong-Helouvry 1991). In a log: a force of one sign
//! during any motion, absent at standstill. Confounded with an offset of the effort's sensor, from
//! which only standstills and reversals distinguish it.

use super::kind::{Action, Apply, EffectKind, EffectParameter, Measure};
use crate::description::Plant;
use crate::signals::Channel;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "coulomb-asymmetry",
    summary: "Dry friction differs between the two directions.",
    shows_in: Some(Channel::FrictionTorque),
    confounded_with: &[
        "coulomb-level",
        "load-dependent-friction",
        "sensor-drift",
        "sensor-offset",
        "viscous-asymmetry",
    ],
    refines: Some("coulomb-level"),
    actions: &[
        Action {
            plants: Plant::TRANSMISSION,
            parameters: &[EffectParameter::size("asymmetry", "1", 0.02, [-1.0, 1.0], 0.1)],
            apply: Apply::Transmission(|bench, parameter| {
                bench.extension.coulomb_asymmetry += parameter("asymmetry")
            }),
        },
        Action {
            plants: Plant::AXES,
            parameters: &[EffectParameter::size("asymmetry_effort", "N or N m", 1e-3, [-1e9, 1e9], 3.0)
                .in_log(Measure::Effort)],
            apply: Apply::Axis(|rig, parameter| rig.axis.coulomb_asymmetry += parameter("asymmetry_effort")),
        },
    ],
    ..EffectKind::DEFAULT
};
