//! Effects of the transmission bench: their names, their random draws (see [`super::vocabulary`]),
//! and the terms that they add to the planar bench of [`super::planar_plant`], in SI units.
//!
//! The planar generator does not show `breakaway`, `presliding-hysteresis` and
//! `thermal-friction-drift`, because its friction has no memory; the axes hide these.

use super::drawn::{Draw, Drawn};
use super::hidden::{HiddenEffect, total};
use super::noise::Noise;
use std::f64::consts::TAU;

/// Reference of the load exponent, N.
const REFERENCE_N: f64 = 10e3;
/// Length of the ramp of a step of friction, s.
const RAMP_S: f64 = 4e-3;

/// Effects of the plant that the planar generator can show, without sensor effects.
pub(super) const EFFECTS: &[&str] = &[
    "clearance-wear",
    "contact-stiffness",
    "restitution",
    "inertia-mismatch",
    "lever-ratio",
    "stribeck-friction",
    "coulomb-level",
    "viscous-friction",
    "viscous-asymmetry",
    "coulomb-asymmetry",
    "load-dependent-friction",
    "friction-step",
    "seal-friction",
    "position-ripple",
    "hydraulic-compliance",
    "drive-lag",
    "load-ripple",
    "journal-out-of-round",
    "squeeze-film",
    "fork-backlash",
    "shaft-flexibility",
];

/// The same for the bench whose shaft may tilt.
pub(super) const TILTING: &[&str] = &[
    "clearance-wear",
    "contact-stiffness",
    "restitution",
    "misalignment",
    "inertia-mismatch",
    "lever-ratio",
    "stribeck-friction",
    "coulomb-level",
    "viscous-friction",
    "viscous-asymmetry",
    "coulomb-asymmetry",
    "load-dependent-friction",
    "friction-step",
    "seal-friction",
    "drive-lag",
    "load-ripple",
];

/// Parameters that define the size of an effect. Effects whose parameters have the same names on an
/// axis are left out.
pub(super) const SIZES: &[(&str, &[&str])] = &[
    ("clearance-wear", &["clearance_increase_m"]),
    ("contact-stiffness", &["relative_change"]),
    ("restitution", &["restitution_change"]),
    ("journal-out-of-round", &["cosine_m", "sine_m"]),
    ("misalignment", &["slope_y_rad", "slope_z_rad"]),
    ("inertia-mismatch", &["relative_change"]),
    ("shaft-flexibility", &["compliance_rad_nm"]),
    ("lever-ratio", &["relative_change"]),
    ("stribeck-friction", &["coefficient_rise"]),
    ("coulomb-level", &["relative_change"]),
    ("viscous-friction", &["viscous_n_s_m"]),
    ("viscous-asymmetry", &["asymmetry_n_s_m"]),
    ("coulomb-asymmetry", &["asymmetry"]),
    ("load-dependent-friction", &["load_exponent"]),
    ("breakaway", &["excess"]),
    ("friction-step", &["relative_change"]),
    ("seal-friction", &["seal_force_n"]),
    ("position-ripple", &["cos_torque_nm", "sin_torque_nm"]),
    ("hydraulic-compliance", &["compliance_m_n"]),
    ("fork-backlash", &["backlash_m"]),
    ("squeeze-film", &["viscosity_pa_s"]),
];

/// Effects with one size of either sign: its parameter, its guess and its largest value.
const ONE_SIZE: &[(&str, &str, f64, f64)] = &[
    ("clearance-wear", "clearance_increase_m", 5e-5, 3e-4),
    ("contact-stiffness", "relative_change", 0.2, 0.7),
    ("restitution", "restitution_change", 0.1, 0.3),
    ("inertia-mismatch", "relative_change", 0.3, 0.7),
    ("lever-ratio", "relative_change", 0.015, 0.25),
    ("coulomb-level", "relative_change", 0.2, 0.9),
    ("viscous-friction", "viscous_n_s_m", 200.0, 1e5),
    ("viscous-asymmetry", "asymmetry_n_s_m", 200.0, 1e5),
    ("coulomb-asymmetry", "asymmetry", 0.05, 0.9),
    ("load-dependent-friction", "load_exponent", 0.1, 0.9),
];

/// Draws an effect of the bench.
pub(super) fn draw(effect: &str, sign: f64, phase: f64, noise: &mut Noise) -> Option<Drawn> {
    let mut between = |low: f64, high: f64| low * (high / low).powf(noise.uniform());
    if let Some(&(_, name, guess, most)) = ONE_SIZE.iter().find(|(known, ..)| *known == effect) {
        return Some(Drawn {
            effect: HiddenEffect::new(effect, &[]),
            sizes: vec![(name, sign)],
            guess,
            most,
        });
    }
    let (sizes, guess, most, shapes): Draw = match effect {
        "stribeck-friction" => {
            (vec![("coefficient_rise", sign)], 0.03, 0.13, vec![("speed_m_s", between(0.005, 0.03))])
        }
        "friction-step" => {
            (vec![("relative_change", sign)], 0.1, 0.9, vec![("time_s", 0.2 + 1.6 * noise.uniform())])
        }
        "seal-friction" => (vec![("seal_force_n", 1.0)], 50.0, 1e5, vec![]),
        "position-ripple" => (
            vec![("cos_torque_nm", phase.cos()), ("sin_torque_nm", phase.sin())],
            10.0,
            1e4,
            vec![("period_rad", between(0.05, 0.3))],
        ),
        "hydraulic-compliance" => (vec![("compliance_m_n", 1.0)], 1e-8, 1e-6, vec![]),
        "drive-lag" => (vec![("lag_s", 1.0)], 2e-4, 0.05, vec![]),
        "load-ripple" => (
            vec![("cos_force_n", phase.cos()), ("sin_force_n", phase.sin())],
            30.0,
            1e4,
            vec![("frequency_hz", between(5.0, 100.0))],
        ),
        "journal-out-of-round" => {
            (vec![("cosine_m", phase.cos()), ("sine_m", phase.sin())], 5e-6, 2e-4, vec![])
        }
        "misalignment" => {
            (vec![("slope_y_rad", phase.cos()), ("slope_z_rad", phase.sin())], 3e-5, 3e-3, vec![])
        }
        "squeeze-film" => {
            (vec![("viscosity_pa_s", 1.0)], 1e-3, 0.02, vec![("least_film_m", between(1e-5, 4e-5))])
        }
        "fork-backlash" => (vec![("backlash_m", 1.0)], 1e-4, 2e-3, vec![]),
        "shaft-flexibility" => (vec![("compliance_rad_nm", 1.0)], 5e-7, 5e-6, vec![]),
        _ => return None,
    };
    Some(Drawn { effect: HiddenEffect::new(effect, &shapes), sizes, guess, most })
}

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

impl Added {
    /// Returns the friction in N along the sliding direction. `coefficient` is that of the bench,
    /// `viscous` its force over the sliding speed.
    pub(super) fn friction_n(
        &self,
        (t, normal): (f64, f64),
        (slide, sign): (f64, f64),
        mut coefficient: f64,
        viscous: f64,
    ) -> f64 {
        if self.stribeck.0 != 0.0 {
            coefficient += self.stribeck.0 / (slide.abs() / self.stribeck.1).exp();
        }
        coefficient *= 1.0 + self.coulomb_asymmetry * sign;
        if self.load_exponent != 0.0 && normal > 0.0 {
            coefficient *= (self.load_exponent * (normal / REFERENCE_N).ln()).exp();
        }
        coefficient *= 1.0 + self.step.0 * ((t - self.step.1) / RAMP_S + 0.5).clamp(0.0, 1.0);
        -coefficient * normal * sign - (viscous + self.viscous_asymmetry * sign) * slide
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generator::plant::Plant;
    use crate::generator::record::{Point, Record};

    #[test]
    fn every_effect_changes_the_log_by_more_than_its_noise() {
        for (plant, effects) in [(Plant::Bench, EFFECTS), (Plant::TwoPlane, TILTING)] {
            let mut noise = Noise::new(4);
            let mut record = Record::draw(plant, 0.8, Point::default(), &mut noise);
            record.cycles = 1.0;
            let base = record.readings(&record.off, &[]);
            let sensors = record.sensors();
            for effect in effects {
                let drawn = draw(effect, 1.0, 0.7, &mut noise).unwrap();
                let mut hidden = drawn.at(drawn.guess);
                if *effect == "friction-step" {
                    hidden.parameters.insert("time_s".into(), 0.5);
                }
                let with = record.readings(&record.off, &[hidden]);
                let most = with.iter().zip(&base).zip(plant.outputs()).map(|((w, b), channel)| {
                    let floor = sensors.iter().find(|s| s.channel == *channel).unwrap().floor();
                    let landing = (plant.landing_s() * record.logger.rate_hz).round() as usize;
                    w.iter().zip(b).skip(landing).map(|(w, b)| (w - b).abs() / floor).fold(0.0, f64::max)
                });
                let most = most.fold(0.0, f64::max);
                assert!(most > 1.0 && most.is_finite(), "{effect}: {most}");
            }
        }
    }
}
