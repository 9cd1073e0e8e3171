//! The load crank is longer or shorter than described.
//!
//! `R_l' = R_l (1 + relative_change)`. Parameter: `relative_change`, -0.3 to 0.3, prior 0.02 (a
//! refitted pin, a worn hole). Plain geometry. In a log: `bearing_force_y_n` and `drive_force_n`
//! change in proportion to the load, `F_L R_l/R_d`. Confounded with the gain of the load cell or of
//! the force sensors, and under a constant load with their offsets.

use super::kind::{Action, Apply, EffectKind, EffectParameter};
use crate::description::Plant;
use crate::signals::Channel;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "lever-ratio",
    summary: "The load crank's radius differs from its description by a factor.",
    shows_in: Some(Channel::BearingForceY),
    confounded_with: &[
        "inertia-mismatch",
        "load-ripple",
        "seal-friction",
        "sensor-gain",
        "sensor-offset",
        "shaft-flexibility",
    ],
    actions: &[Action {
        plants: Plant::TRANSMISSION,
        parameters: &[EffectParameter::size("relative_change", "1", 0.002, [-0.3, 0.3], 0.02)],
        apply: Apply::Transmission(|bench, parameter| {
            bench.geometry.load_lever_radius_m *= 1.0 + parameter("relative_change")
        }),
    }],
    ..EffectKind::DEFAULT
};
