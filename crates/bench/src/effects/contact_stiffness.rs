//! The bearing is softer or harder than described.
//!
//! `E' = E (1 + relative_change)` of the bearing, for every stiffness part; the damping of a
//! factorised law changes in proportion. Joint of a mechanism: the modulus of its contacts and the
//! `coefficient` of a law that has one. Parameter: `relative_change`, -0.8 to 4, prior 0.3 (moduli
//! of lining alloys and filled plastics scatter that much with temperature and batch). In a log:
//! the journal is deeper or less deep in the bearing under the same force, by tens of micrometres
//! at 10 kN. Confounded with the clearance if the force hardly varies, and with the gain of the
//! journal's sensors.

use super::kind::{Action, Apply, EffectKind, EffectParameter};
use crate::description::{Part, Plant};
use crate::signals::Channel;

const CHANGE: &[EffectParameter] = &[EffectParameter::size("relative_change", "1", 0.02, [-0.8, 4.0], 0.3)];

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "contact-stiffness",
    summary: "The bearing's modulus differs from its description by a factor.",
    shows_in: Some(Channel::JournalY),
    confounded_with: &[
        "clearance-wear",
        "journal-out-of-round",
        "misalignment",
        "restitution",
        "sensor-gain",
        "squeeze-film",
    ],
    actions: &[
        Action {
            plants: Plant::TRANSMISSION,
            parameters: CHANGE,
            apply: Apply::Transmission(|bench, parameter| {
                bench.bearing.youngs_modulus_pa *= 1.0 + parameter("relative_change")
            }),
        },
        Action {
            plants: Plant::MECHANISM,
            parameters: CHANGE,
            apply: Apply::Mechanism(Part::Contact, |bench, joint, parameter| {
                let Some(contact) = bench.own_contact_mut(joint) else { return };
                let factor = 1.0 + parameter("relative_change");
                contact.coefficient = contact.coefficient.map(|coefficient| coefficient * factor);
                contact.youngs_modulus_pa *= factor;
            }),
        },
    ],
    ..EffectKind::DEFAULT
};
