//! Dry friction changes along the stroke.
//!
//! Dry friction of an axis grows by `c (x - x_0)` at position `x`, with `x_0` the described
//! `neutral_position`, where the level is as described. The cause is a guide out of parallel, a
//! bore that narrows, or a worn part of the stroke. Parameter: `friction_slope` in N/m or N m/rad
//! (within 1e12, prior 3 times the log's rms effort over half the stroke). In a log: force over
//! position is a wedge, wider at one end of the stroke, the same at every speed. Confounded with a
//! level of friction if the neutral position lies outside the stroke, and with friction over time
//! if the log has one stroke only.

use super::kind::{Action, Apply, EffectKind, EffectParameter, Measure};
use crate::description::Plant;
use crate::signals::Channel;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "position-friction",
    summary: "Dry friction changes along the stroke.",
    shows_in: Some(Channel::DriveForce),
    confounded_with: &["coulomb-level", "friction-step", "thermal-friction-drift", "viscous-asymmetry"],
    actions: &[Action {
        plants: Plant::AXES,
        parameters: &[EffectParameter::size("friction_slope", "N/m or N m/rad", 1e-3, [-1e12, 1e12], 3.0)
            .in_log(Measure::Stiffness)],
        apply: Apply::Axis(|rig, parameter| rig.extension.friction_slope += parameter("friction_slope")),
    }],
    ..EffectKind::DEFAULT
};
