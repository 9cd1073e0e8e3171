//! The load crank is longer or shorter than described.
//!
//! `R_l' = R_l (1 + relative_change)`. Parameter: `relative_change`, -0.3 to 0.3, prior 0.02 (a pin refitted, a hole
//! worn). Plain geometry.
//! In a log: `bearing_force_y_n` and `drive_force_n` in proportion to the load, `F_L R_l/R_d`.
//! Confounded with a factor of the load cell or of the force sensors under a constant load, and with an offset of theirs.

use super::kind::{EffectKind, EffectParameter, Guess, Plant};
use crate::channel::Channel;
use crate::description::Bench;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "lever-ratio",
    summary: "The load crank's radius differs from its description by a factor.",
    per_channel: false,
    plants: &[Plant::Planar, Plant::TwoPlane],
    transmission: &[EffectParameter::size("relative_change", "1", 0.002, [-0.3, 0.3], 0.02)],
    axis: &[],
    shows_in: Some(Channel::BearingForceY),
    confounded_with: &[
        "inertia-mismatch",
        "load-ripple",
        "seal-friction",
        "sensor-gain",
        "sensor-offset",
        "shaft-flexibility",
    ],
    guess: Guess::Defaults,
    apply: |bench, _, parameter| {
        if let Bench::Transmission(bench) = bench {
            bench.geometry.load_lever_radius_m *= 1.0 + parameter("relative_change");
        }
    },
};
