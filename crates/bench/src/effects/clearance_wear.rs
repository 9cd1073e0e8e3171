//! Wear: the bearing's radial clearance is larger than described.
//!
//! `D' = D + clearance_increase_m` of the bearing, or of a bearing or guide of a mechanism. On a
//! transmission bench the bearing's radius increases and the journal's stays; on a mechanism the
//! journal's decreases. Plain geometry without a source. Parameter: `clearance_increase_m` in m,
//! -0.4 mm to 2 mm, prior 0.2 mm. In a log: the journal moves on a wider circle. It swings more
//! slowly (frequency as `D^-1/2`), and more strongly where the drive's acceleration changes sign.
//! `journal_y_m` and `journal_z_m` show it first. Confounded with a softer contact (both allow more
//! displacement under load) and, with one journal axis alone, with that sensor's offset.

use super::kind::{Action, Apply, EffectKind, EffectParameter};
use crate::description::{Part, Plant};
use crate::signals::Channel;

const INCREASE: &[EffectParameter] =
    &[EffectParameter::size("clearance_increase_m", "m", 1e-5, [-4e-4, 2e-3], 2e-4)];

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "clearance-wear",
    summary: "The bearing has worn: its radial clearance is larger than described.",
    shows_in: Some(Channel::JournalZ),
    confounded_with: &[
        "contact-stiffness",
        "journal-out-of-round",
        "misalignment",
        "sensor-gain",
        "sensor-offset",
        "squeeze-film",
    ],
    actions: &[
        Action {
            plants: Plant::TRANSMISSION,
            parameters: INCREASE,
            apply: Apply::Transmission(|bench, parameter| {
                bench.bearing.radial_clearance_m += parameter("clearance_increase_m")
            }),
        },
        Action {
            plants: Plant::MECHANISM,
            parameters: INCREASE,
            apply: Apply::Mechanism(Part::Clearance, |bench, joint, parameter| {
                if let Some(clearance_m) = bench.joint_mut(joint).and_then(|j| j.clearance_m.as_mut()) {
                    *clearance_m += parameter("clearance_increase_m");
                }
            }),
        },
    ],
    ..EffectKind::DEFAULT
};
