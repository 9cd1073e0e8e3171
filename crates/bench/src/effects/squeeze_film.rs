//! A lubricant film in the clearance damps the normal motion.
//!
//! Force `-C a'` along the normal, in the gap and in contact, with `C = 12 pi eta L (R/D)^3 / (1 -
//! e^2)^(3/2)`, `e = a/D`: the long journal bearing without cavitation in pure squeeze (Pinkus and
//! Sternlicht, Theory of Hydrodynamic Lubrication, 1961). Roughness maintains a film: `1 - e^2` is
//! at least `2 h/D`. Parameters: `viscosity_pa_s`, 0 to 0.1, prior 1e-3; shape `least_film_m`, 5e-6
//! to 1e-3, default 20 um, prior 10 um. The formula overestimates a bearing as short as this one,
//! so the viscosity is an effective one. In a log: less swinging in `journal_y_m` and
//! `journal_z_m`, a softer landing at the start. The film's force is part of the bearing force.
//! Confounded with restitution: in sustained contact both damp the normal motion.

use super::kind::{Action, Apply, EffectKind, EffectParameter};
use crate::description::{FilmTerm, Plant};
use crate::signals::Channel;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "squeeze-film",
    summary: "A lubricant film in the clearance damps the normal motion.",
    shows_in: Some(Channel::JournalZ),
    confounded_with: &["clearance-wear", "contact-stiffness", "restitution"],
    actions: &[Action {
        plants: &[Plant::Planar],
        parameters: &[
            EffectParameter::size("viscosity_pa_s", "Pa s", 1e-4, [0.0, 0.1], 1e-3),
            EffectParameter::shape("least_film_m", "m", 2e-5, [5e-6, 1e-3], 1e-5),
        ],
        apply: Apply::Transmission(|bench, parameter| {
            bench.extension.film = Some(FilmTerm {
                viscosity_pa_s: parameter("viscosity_pa_s"),
                min_thickness_m: parameter("least_film_m"),
            });
        }),
    }],
    ..EffectKind::DEFAULT
};
