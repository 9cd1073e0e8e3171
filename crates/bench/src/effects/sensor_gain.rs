//! A sensor's gain is wrong.
//!
//! `reading = gain (1 + relative_change) signal + offset`. Parameter: `relative_change`, -0.99 to
//! 0.99, prior 0.1. In a log: one channel deviates in proportion to its own value. Confounded with
//! effects that scale that channel alone: the friction level (torque), inertia (force), stiffness
//! (journal).

use super::kind::{Action, Apply, EffectKind, EffectParameter};
use crate::description::Plant;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "sensor-gain",
    summary: "A sensor's gain is wrong.",
    confounded_with: &[
        "clearance-wear",
        "contact-stiffness",
        "coulomb-level",
        "inertia-mismatch",
        "journal-out-of-round",
        "lever-ratio",
        "sensor-saturation",
        "viscous-friction",
    ],
    actions: &[Action {
        plants: Plant::ALL,
        parameters: &[EffectParameter::size("relative_change", "1", 0.01, [-0.99, 0.99], 0.1)],
        apply: Apply::Sensor(|sensor, parameter| sensor.gain *= 1.0 + parameter("relative_change")),
    }],
    ..EffectKind::DEFAULT
};
