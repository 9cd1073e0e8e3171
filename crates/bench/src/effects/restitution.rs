//! Impacts return more or less energy than described.
//!
//! `e' = e + restitution_change`, limited to 0.05 to 1, in the dissipation factor `chi(e)` of the
//! description, on a mechanism of one joint (for the restitution that a factor really produces see
//! `contact::restitution`). Parameter: `restitution_change`, -0.35 to 0.55, prior 0.1. In a log:
//! the swinging after an impact or a change of sign decays faster or more slowly; at standstill
//! nothing changes. Confounded with a squeeze film, which also damps the normal motion.

use super::kind::{Action, Apply, EffectKind, EffectParameter, Values};
use crate::description::{Part, Plant};
use crate::signals::Channel;

const CHANGE: &[EffectParameter] =
    &[EffectParameter::size("restitution_change", "1", 0.02, [-0.35, 0.55], 0.1)];

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "restitution",
    summary: "The restitution of the contact differs from its description.",
    shows_in: Some(Channel::JournalZ),
    confounded_with: &["contact-stiffness", "squeeze-film"],
    actions: &[
        Action {
            plants: Plant::TRANSMISSION,
            parameters: CHANGE,
            apply: Apply::Transmission(|bench, parameter| {
                change(&mut bench.bearing.restitution, parameter);
            }),
        },
        Action {
            plants: Plant::MECHANISM,
            parameters: CHANGE,
            apply: Apply::Mechanism(Part::Contact, |bench, joint, parameter| {
                if let Some(contact) = bench.own_contact_mut(joint) {
                    change(&mut contact.restitution, parameter);
                }
            }),
        },
    ],
    ..EffectKind::DEFAULT
};

fn change(restitution: &mut f64, parameter: &Values<'_>) {
    *restitution = (*restitution + parameter("restitution_change")).clamp(0.05, 1.0);
}
