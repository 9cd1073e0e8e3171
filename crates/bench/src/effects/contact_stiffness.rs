//! The bearing is softer or harder than described.
//!
//! `E' = E (1 + relative_change)` of the bearing, in whatever stiffness part the description names; the damping of a
//! factorised law follows in proportion. Parameter: `relative_change`, -0.8 to 4, prior 0.3 (moduli of lining alloys and
//! filled plastics scatter that much with temperature and batch).
//! In a log: the journal stands deeper or less deep in the bearing under the same force, by tens of micrometres at 10 kN.
//! Confounded with the clearance on a trajectory whose force hardly varies, and with a factor of the journal's sensors.

use super::kind::{EffectKind, EffectParameter, Guess, Plant};
use crate::channel::Channel;
use crate::description::Bench;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "contact-stiffness",
    summary: "The bearing's modulus differs from its description by a factor.",
    per_channel: false,
    plants: &[Plant::Planar, Plant::TwoPlane],
    transmission: &[EffectParameter::size("relative_change", "1", 0.02, [-0.8, 4.0], 0.3)],
    axis: &[],
    shows_in: Some(Channel::JournalY),
    confounded_with: &[
        "clearance-wear",
        "journal-out-of-round",
        "misalignment",
        "restitution",
        "sensor-gain",
        "squeeze-film",
    ],
    guess: Guess::Defaults,
    apply: |bench, _, parameter| {
        if let Bench::Transmission(bench) = bench {
            bench.bearing.youngs_modulus_pa *= 1.0 + parameter("relative_change");
        }
    },
};
