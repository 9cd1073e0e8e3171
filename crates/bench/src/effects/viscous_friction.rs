//! Friction proportional to speed.
//!
//! Bearing: force `-c v` on the journal at the sliding speed `v`, `viscous_n_s_m` in N s/m (within
//! 1e6, prior 1e4). Axis: effort `c` times its speed, `viscous_effort` in N s/m or N m s/rad
//! (within 1e9, prior 3 times the log's rms effort over its rms speed). Pin of a mechanism: torque
//! `c` times the relative speed of its bodies, `viscous_torque` in N m s/rad (0 to 1e9, prior 3
//! times the drive's rms torque over its rms speed). Newton's law of viscosity.
//! In a log: friction that follows the speed through zero, symmetric in both directions. Confounded
//! with a delay or lag of a sinusoidal motion (both shift a force by a quarter of a period), with
//! Stribeck friction of the opposite sign, and with asymmetric viscous friction if the motion is
//! mostly in one direction.

use super::kind::{Action, Apply, EffectKind, EffectParameter, Measure};
use crate::description::{Part, Plant};
use crate::signals::Channel;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "viscous-friction",
    summary: "A friction force proportional to speed is missing.",
    shows_in: Some(Channel::FrictionTorque),
    confounded_with: &["drive-lag", "sensor-delay", "sensor-gain", "stribeck-friction", "viscous-asymmetry"],
    actions: &[
        Action {
            plants: Plant::TRANSMISSION,
            parameters: &[EffectParameter::size("viscous_n_s_m", "N s/m", 100.0, [-1e6, 1e6], 1e4)],
            apply: Apply::Transmission(|bench, parameter| {
                bench.extension.viscous_n_s_m += parameter("viscous_n_s_m")
            }),
        },
        Action {
            plants: Plant::AXES,
            parameters: &[EffectParameter::size(
                "viscous_effort",
                "N s/m or N m s/rad",
                1e-3,
                [-1e9, 1e9],
                3.0,
            )
            .in_log(Measure::Drag)],
            apply: Apply::Axis(|rig, parameter| rig.axis.viscous_effort += parameter("viscous_effort")),
        },
        Action {
            plants: Plant::MECHANISM,
            parameters: &[EffectParameter::size("viscous_torque", "N m s/rad", 1e-3, [0.0, 1e9], 3.0)
                .in_log(Measure::Drag)],
            apply: Apply::Mechanism(Part::Pin, |bench, joint, parameter| {
                bench.add_torsion(joint, 0.0, parameter("viscous_torque"));
            }),
        },
    ],
    ..EffectKind::DEFAULT
};
