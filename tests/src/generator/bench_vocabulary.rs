//! How the effects of the transmission bench are drawn. See [`super::vocabulary`].

use super::hidden::HiddenEffect;
use super::noise::Noise;
use super::vocabulary::Drawn;

/// Effects of the plant that the planar bench can show; those of its sensors come on top.
pub const EFFECTS: &[&str] =
    &["clearance-wear", "coulomb-level", "viscous-friction", "hydraulic-compliance"];

/// Draws an effect of the bench.
pub fn draw(effect: &str, sign: f64, _phase: f64, _noise: &mut Noise) -> Option<Drawn> {
    let (sizes, guess, most, shapes): (Vec<(&'static str, f64)>, f64, f64, Vec<(&str, f64)>) = match effect {
        "clearance-wear" => (vec![("clearance_increase_m", sign)], 5e-5, 4e-4, vec![]),
        "coulomb-level" => (vec![("relative_change", sign)], 0.2, 2.0, vec![]),
        "viscous-friction" => (vec![("viscous_n_s_m", sign)], 200.0, 1e5, vec![]),
        "hydraulic-compliance" => (vec![("compliance_m_n", 1.0)], 1e-8, 1e-6, vec![]),
        _ => return None,
    };
    Some(Drawn { effect: HiddenEffect::new(effect, &shapes), sizes, guess, most })
}
