//! A force that repeats over the position: a tooth, a screw, a magnet, a coupling.
//!
//! Torque on the shaft `A cos(2 pi th/p) + B sin(2 pi th/p)` over its angle `th` from a potential (no energy is lost), or effort of
//! an axis over its position. Position-dependent ripple as in servo drives (cogging). Parameters: `cos_torque_nm`, `sin_torque_nm`
//! (within 1e6, prior 50 N m) and shape `period_rad` (1e-3 to 10, 0.05 unless given, prior 0.5); on an axis `cos_effort`,
//! `sin_effort` in N or N m (within 1e9, prior 1e3) and `period` in rad or m (1e-6 to 1e3, 0.05 unless given, prior 0.5).
//! In a log: on the bench in `drive_force_n` and the bearing force, the same at the same angle whatever the speed.
//! Confounded with inertia (on a sine, acceleration is position with its sign changed) where the period is as long as the stroke.

use super::kind::{EffectKind, EffectParameter, Guess, Plant};
use crate::channel::Channel;
use crate::description::{Bench, RippleTerm};

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "position-ripple",
    summary: "A force that repeats over the position is missing.",
    per_channel: false,
    plants: &[Plant::Planar, Plant::Rotary, Plant::Linear],
    transmission: &[
        EffectParameter::size("cos_torque_nm", "N m", 2.0, [-1e6, 1e6], 50.0),
        EffectParameter::size("sin_torque_nm", "N m", 2.0, [-1e6, 1e6], 50.0),
        EffectParameter {
            scale: 1e-3,
            ..EffectParameter::shape("period_rad", "rad", 0.05, [1e-3, 10.0], 0.5)
        },
    ],
    axis: &[
        EffectParameter::size("cos_effort", "N or N m", 0.1, [-1e9, 1e9], 1e3),
        EffectParameter::size("sin_effort", "N or N m", 0.1, [-1e9, 1e9], 1e3),
        EffectParameter {
            scale: 1e-4,
            ..EffectParameter::shape("period", "m or rad", 0.05, [1e-6, 1e3], 0.5)
        },
    ],
    shows_in: Some(Channel::DriveForce),
    confounded_with: &["inertia-mismatch", "load-ripple", "viscous-asymmetry"],
    guess: Guess::Wavelength,
    apply: |bench, _, parameter| {
        let term = |cos: &str, sin: &str, period: &str| RippleTerm {
            cos: parameter(cos),
            sin: parameter(sin),
            per_unit: 1.0 / parameter(period),
        };
        match bench {
            Bench::Transmission(bench) => {
                let term = term("cos_torque_nm", "sin_torque_nm", "period_rad");
                bench.extension.position_ripples.push(term);
            }
            Bench::FrictionRig(rig) => {
                rig.extension.position_ripples.push(term("cos_effort", "sin_effort", "period"));
            }
        }
    },
};
