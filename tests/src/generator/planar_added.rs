//! Terms that effects add to the planar bench of [`super::planar_plant`], beyond changed
//! parameters, in SI units.

use super::hidden::{HiddenEffect, total};
use std::f64::consts::TAU;

/// Parameters of the added terms.
#[derive(Default)]
pub(super) struct Added {
    pub(super) stribeck: (f64, f64),
    pub(super) coulomb_asymmetry: f64,
    pub(super) viscous_asymmetry: f64,
    pub(super) load_exponent: f64,
    pub(super) step: (f64, f64),
    pub(super) position_ripple: (f64, f64, f64),
    pub(super) load_ripple: (f64, f64, f64),
    pub(super) seal_n: f64,
    pub(super) lag_s: f64,
    /// Second harmonic of the journal's radius: cosine, sine.
    pub(super) oval: (f64, f64),
    /// Viscosity and minimum thickness of the film.
    pub(super) film: (f64, f64),
}

impl Added {
    pub(super) fn new(effects: &[HiddenEffect]) -> Self {
        let of = |effect: &str, parameter: &str| total(effects, effect, parameter);
        let three = |effect: &str, [a, b, c]: [&str; 3]| (of(effect, a), of(effect, b), of(effect, c));
        Self {
            stribeck: (of("stribeck-friction", "coefficient_rise"), of("stribeck-friction", "speed_m_s")),
            coulomb_asymmetry: of("coulomb-asymmetry", "asymmetry"),
            viscous_asymmetry: of("viscous-asymmetry", "asymmetry_n_s_m"),
            load_exponent: of("load-dependent-friction", "load_exponent"),
            step: (of("friction-step", "relative_change"), of("friction-step", "time_s")),
            position_ripple: three("position-ripple", ["cos_torque_nm", "sin_torque_nm", "period_rad"]),
            load_ripple: three("load-ripple", ["cos_force_n", "sin_force_n", "frequency_hz"]),
            seal_n: of("seal-friction", "seal_force_n"),
            lag_s: of("drive-lag", "lag_s"),
            oval: (of("journal-out-of-round", "cosine_m"), of("journal-out-of-round", "sine_m")),
            film: (of("squeeze-film", "viscosity_pa_s"), of("squeeze-film", "least_film_m")),
        }
    }
}

/// Returns `A cos + B sin` of a position on a period; 0 without amplitude.
pub(super) fn wave((cosine, sine, period): (f64, f64, f64), place: f64) -> f64 {
    if cosine == 0.0 && sine == 0.0 {
        return 0.0;
    }
    let (s, c) = (TAU * place / period).sin_cos();
    cosine * c + sine * s
}
