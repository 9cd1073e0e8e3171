//! The effort contains another share of the load than described.
//!
//! Effort `g F` of an axis in addition to the described `load_gain` under the load `F`. The cause
//! is an area of a piston, a lever, or the gain of the load's sensor. Parameter: `gain_change` in
//! N/N or N m/N (within 1e3, prior 3 times the log's rms effort over its rms load). In a log: the
//! error follows the load in either direction of motion. Visible only if the load varies;
//! confounded with an offset of the effort under a constant load, and with dry friction that
//! depends on the load if the axis moves in one direction only.

use super::kind::{Action, Apply, EffectKind, EffectParameter, Measure};
use crate::description::Plant;
use crate::signals::Channel;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "load-gain",
    summary: "The effort contains another share of the load than described.",
    shows_in: Some(Channel::DriveForce),
    confounded_with: &["load-dependent-friction", "load-ripple", "sensor-gain", "sensor-offset"],
    actions: &[Action {
        plants: Plant::AXES,
        parameters: &[EffectParameter::size("gain_change", "N/N or N m/N", 1e-3, [-1e3, 1e3], 3.0)
            .in_log(Measure::LoadGain)],
        apply: Apply::Axis(|rig, parameter| rig.axis.load_gain += parameter("gain_change")),
    }],
    ..EffectKind::DEFAULT
};
