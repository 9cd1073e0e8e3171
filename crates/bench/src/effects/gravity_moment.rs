//! A moment of gravity on a rotary axis, such as that of an unbalanced mass, is missing.
//!
//! Moment `C cos(q) + S sin(q)` at the angle `q`: a mass `m` at the distance `r` from a horizontal
//! axis has `C^2 + S^2 = (m g r)^2`, with the ratio of `C` and `S` given by where the angle is
//! zero. Arms, unbalanced rudders and pendulums have this form. Parameters: `cos_effort`,
//! `sin_effort` in N m (within 1e12, prior 3 times the log's rms effort). In a log: the effort
//! depends on the angle, with the period of a turn. Confounded with a spring and an offset over a
//! small range of angles, with inertia under one sine, and with a ripple over a turn.

use super::kind::{Action, Apply, EffectKind, EffectParameter, Measure};
use crate::description::Plant;
use crate::signals::Channel;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "gravity-moment",
    summary: "A moment of gravity that turns with the axis is missing.",
    shows_in: Some(Channel::DriveTorque),
    confounded_with: &["inertia-mismatch", "position-ripple", "sensor-offset", "spring-effort"],
    actions: &[Action {
        plants: &[Plant::Rotary],
        parameters: &[
            EffectParameter::size("cos_effort", "N m", 1e-3, [-1e12, 1e12], 3.0).in_log(Measure::Effort),
            EffectParameter::size("sin_effort", "N m", 1e-3, [-1e12, 1e12], 3.0).in_log(Measure::Effort),
        ],
        apply: Apply::Axis(|rig, parameter| {
            rig.axis.gravity_cos += parameter("cos_effort");
            rig.axis.gravity_sin += parameter("sin_effort");
        }),
    }],
    ..EffectKind::DEFAULT
};
