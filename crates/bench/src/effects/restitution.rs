//! Impacts return more or less energy than described.
//!
//! `e' = e + restitution_change`, held within 0.05 to 1, in the dissipation factor `chi(e)` of the description (the
//! restitution that a factor really produces: `contact::restitution`). Parameter: `restitution_change`, -0.35 to 0.55,
//! prior 0.1.
//! In a log: the swinging after an impact or a change of sign dies out faster or more slowly; nothing changes at rest.
//! Confounded with a squeezed film, which also damps the normal motion.

use super::kind::{EffectKind, EffectParameter, Guess, Plant};
use crate::channel::Channel;
use crate::description::Bench;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "restitution",
    summary: "The restitution of the contact differs from its description.",
    per_channel: false,
    plants: &[Plant::Planar, Plant::TwoPlane],
    transmission: &[EffectParameter::size("restitution_change", "1", 0.02, [-0.35, 0.55], 0.1)],
    axis: &[],
    shows_in: Some(Channel::JournalZ),
    confounded_with: &["contact-stiffness", "squeeze-film"],
    guess: Guess::Defaults,
    apply: |bench, _, parameter| {
        if let Bench::Transmission(bench) = bench {
            let restitution = bench.bearing.restitution + parameter("restitution_change");
            bench.bearing.restitution = restitution.clamp(0.05, 1.0);
        }
    },
};
