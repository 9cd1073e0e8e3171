//! Wear: the bearing's radial clearance is larger than described.
//!
//! `D' = D + clearance_increase_m` (the bearing's radius grows with it; the journal keeps its own). Plain geometry, no
//! source needed. Parameter: `clearance_increase_m` in m, -0.4 mm to 2 mm, prior 0.2 mm.
//! In a log: the journal moves on a wider circle, swings more slowly (frequency as `D^-1/2`) and harder where the drive's
//! acceleration changes sign; `journal_y_m`, `journal_z_m` show it first.
//! Confounded with a softer contact (both let the journal out farther under load) and, with one journal axis alone, with
//! that sensor's offset.

use super::kind::{EffectKind, EffectParameter, Guess, Plant};
use crate::channel::Channel;
use crate::description::Bench;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "clearance-wear",
    summary: "The bearing has worn: its radial clearance is larger than described.",
    per_channel: false,
    plants: &[Plant::Planar, Plant::TwoPlane],
    transmission: &[EffectParameter::size("clearance_increase_m", "m", 1e-5, [-4e-4, 2e-3], 2e-4)],
    axis: &[],
    shows_in: Some(Channel::JournalZ),
    confounded_with: &[
        "contact-stiffness",
        "journal-out-of-round",
        "misalignment",
        "sensor-gain",
        "sensor-offset",
        "squeeze-film",
    ],
    guess: Guess::Defaults,
    apply: |bench, _, parameter| {
        if let Bench::Transmission(bench) = bench {
            bench.bearing.radial_clearance_m += parameter("clearance_increase_m");
        }
    },
};
