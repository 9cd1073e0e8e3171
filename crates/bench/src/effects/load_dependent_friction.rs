//! Dry friction depends on the load in another way than described.
//!
//! Bearing: the coefficient times `(N/10 kN)^k` under the normal force `N` (`load_exponent`, -0.9
//! to 2, prior 0.1); dry plastics have -0.1 to -0.3 over pressure. Axis: an additional effort `mu
//! |load| r` (`load_coefficient`, within 5, prior 0.1). Amontons' law and its known deviation for
//! polymers (Bowden and Tabor). In a log: friction that is not proportional to the load; visible
//! only if the load varies. Confounded with the level of dry friction under a constant load.

use super::kind::{Action, Apply, EffectKind, EffectParameter};
use crate::description::Plant;
use crate::signals::Channel;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "load-dependent-friction",
    summary: "Dry friction depends on the load in another way than described.",
    shows_in: Some(Channel::FrictionTorque),
    confounded_with: &[
        "coulomb-asymmetry",
        "coulomb-level",
        "seal-friction",
        "stribeck-friction",
        "thermal-friction-drift",
    ],
    refines: Some("coulomb-level"),
    actions: &[
        Action {
            plants: Plant::TRANSMISSION,
            parameters: &[EffectParameter::size("load_exponent", "1", 0.02, [-0.9, 2.0], 0.1)],
            apply: Apply::Transmission(|bench, parameter| {
                bench.extension.load_exponent += parameter("load_exponent")
            }),
        },
        Action {
            plants: Plant::AXES,
            parameters: &[EffectParameter::size("load_coefficient", "1", 0.002, [-5.0, 5.0], 0.1)],
            apply: Apply::Axis(|rig, parameter| rig.axis.load_coefficient += parameter("load_coefficient")),
        },
    ],
    ..EffectKind::DEFAULT
};
