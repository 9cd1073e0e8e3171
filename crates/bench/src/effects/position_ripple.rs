//! A force that is periodic over the position: a tooth, a screw, a magnet, a coupling.
//!
//! Torque on the shaft `A cos(2 pi th/p) + B sin(2 pi th/p)` over its angle `th`, from a potential
//! (without loss), or effort of an axis over its position. Position-dependent ripple as in servo
//! drives (cogging). Parameters: `cos_torque_nm`, `sin_torque_nm` (within 1e6, prior 50 N m) and
//! shape `period_rad` (1e-3 to 10, default 0.05, prior 0.5); on an axis `cos_effort`, `sin_effort`
//! in N or N m (within 1e9, prior 3 times the log's rms effort) and `period` in rad or m (1e-6 to
//! 1e3, default 0.05, prior 0.5). In a log: on the bench in `drive_force_n` and the bearing force,
//! the same at the same angle for every speed. Confounded with inertia if the period is as long as
//! the stroke (under sinusoidal motion the acceleration is proportional to the negative position).

use super::kind::{Action, Apply, EffectKind, EffectParameter, Guess, Measure};
use crate::description::{Plant, RippleTerm};
use crate::signals::Channel;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "position-ripple",
    summary: "A force that is periodic over the position is missing.",
    shows_in: Some(Channel::DriveForce),
    confounded_with: &["inertia-mismatch", "load-ripple", "viscous-asymmetry"],
    guess: Guess::Wavelength,
    actions: &[
        Action {
            plants: &[Plant::Planar],
            parameters: &[
                EffectParameter::size("cos_torque_nm", "N m", 2.0, [-1e6, 1e6], 50.0),
                EffectParameter::size("sin_torque_nm", "N m", 2.0, [-1e6, 1e6], 50.0),
                EffectParameter {
                    scale: 1e-3,
                    ..EffectParameter::shape("period_rad", "rad", 0.05, [1e-3, 10.0], 0.5)
                },
            ],
            apply: Apply::Transmission(|bench, parameter| {
                bench.extension.position_ripples.push(RippleTerm {
                    cos: parameter("cos_torque_nm"),
                    sin: parameter("sin_torque_nm"),
                    per_unit: 1.0 / parameter("period_rad"),
                });
            }),
        },
        Action {
            plants: Plant::AXES,
            parameters: &[
                EffectParameter::size("cos_effort", "N or N m", 1e-3, [-1e9, 1e9], 3.0)
                    .in_log(Measure::Effort),
                EffectParameter::size("sin_effort", "N or N m", 1e-3, [-1e9, 1e9], 3.0)
                    .in_log(Measure::Effort),
                EffectParameter {
                    scale: 1e-4,
                    ..EffectParameter::shape("period", "m or rad", 0.05, [1e-6, 1e3], 0.5)
                },
            ],
            apply: Apply::Axis(|rig, parameter| {
                rig.extension.position_ripples.push(RippleTerm {
                    cos: parameter("cos_effort"),
                    sin: parameter("sin_effort"),
                    per_unit: 1.0 / parameter("period"),
                });
            }),
        },
    ],
    ..EffectKind::DEFAULT
};
