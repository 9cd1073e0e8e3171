//! A film in the clearance damps the normal motion.
//!
//! Force `-C a'` along the normal, in the gap and in contact, with
//! `C = 12 pi eta L (R/D)^3 / (1 - e^2)^(3/2)`, `e = a/D`: the long journal bearing without cavitation in pure squeeze (Pinkus and
//! Sternlicht, Theory of Hydrodynamic Lubrication, 1961). Roughness keeps a film: `1 - e^2` is not less than `2 h/D`. Parameters:
//! `viscosity_pa_s`, 0 to 0.1, prior 1e-3; shape `least_film_m`, 5e-6 to 1e-3, 20 um unless given, prior 10 um. The formula overstates a
//! bearing as short as this one; the viscosity found is an effective one.
//! In a log: less swinging in `journal_y_m`, `journal_z_m`, a softer landing at the start; the film's force is part of the
//! bearing force.
//! Confounded with restitution: in lasting contact both damp the normal motion.

use super::kind::{EffectKind, EffectParameter, Guess, Plant};
use crate::channel::Channel;
use crate::description::{Bench, FilmTerm};

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "squeeze-film",
    summary: "A film in the clearance damps the normal motion.",
    per_channel: false,
    plants: &[Plant::Planar],
    transmission: &[
        EffectParameter::size("viscosity_pa_s", "Pa s", 1e-4, [0.0, 0.1], 1e-3),
        EffectParameter::shape("least_film_m", "m", 2e-5, [5e-6, 1e-3], 1e-5),
    ],
    axis: &[],
    shows_in: Some(Channel::JournalZ),
    confounded_with: &["clearance-wear", "contact-stiffness", "restitution"],
    guess: Guess::Defaults,
    apply: |bench, _, parameter| {
        if let Bench::Transmission(bench) = bench {
            bench.extension.film = Some(FilmTerm {
                viscosity_pa_s: parameter("viscosity_pa_s"),
                least_thickness_m: parameter("least_film_m"),
            });
        }
    },
};
