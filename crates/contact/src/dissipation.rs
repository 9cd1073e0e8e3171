//! Dissipation factors `chi(e)` and the restitution that a factorised law really produces.

use libm::{exp, log};

/// How much of the approach energy a contact turns into heat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dissipation {
    /// No loss: `chi = 0` (Hertz).
    None,
    /// `chi = 3(1-e)/2`, Hunt and Crossley 1975.
    HuntCrossley,
    /// `chi = 3(1-e^2)/4`, Lankarani and Nikravesh 1990.
    LankaraniNikravesh,
    /// `chi = (3/4)(1-e^2) exp(2(1-e))`, Zhiying and Qishao 2006: the factor in the paper's hybrid law.
    ZhiyingQishao,
}

impl Dissipation {
    /// Every factor of the catalogue, for tables and tests.
    pub const ALL: [Self; 4] =
        [Self::None, Self::HuntCrossley, Self::LankaraniNikravesh, Self::ZhiyingQishao];

    /// The dimensionless factor for a nominal restitution in `0 < e <= 1`.
    pub fn factor(self, restitution: f64) -> f64 {
        let e = restitution;
        match self {
            Self::None => 0.0,
            Self::HuntCrossley => 1.5 * (1.0 - e),
            Self::LankaraniNikravesh => 0.75 * (1.0 - e * e),
            Self::ZhiyingQishao => 0.75 * (1.0 - e * e) * exp(2.0 * (1.0 - e)),
        }
    }
}

/// The restitution that a law `F_el(d) (1 + chi d'/d'0)` produces in a free impact, whatever its stiffness,
/// exponent, mass and approach speed.
///
/// Solves `chi (1 + e) = ln((1 + chi)/(1 - chi e))` for its positive root by bisection; 1 for `chi <= 0`.
/// Derivation: separate variables in `m v dv/dx = -F_el (1 + chi v/v0)`; both phases dissipate the same elastic work.
pub fn produced_restitution(factor: f64) -> f64 {
    if factor <= 0.0 {
        return 1.0;
    }
    let residual = |e: f64| factor * (1.0 + e) - log((1.0 + factor) / (1.0 - factor * e));
    // The residual is positive below the root, and tends to minus infinity at e = 1/chi.
    let mut low = 0.0;
    let mut high = if factor > 1.0 { 1.0 / factor } else { 1.0 };
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if residual(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn produced_restitution_matches_the_published_table() {
        for (law, at_04, at_08) in [
            (Dissipation::HuntCrossley, 0.619736, 0.832870),
            (Dissipation::LankaraniNikravesh, 0.701635, 0.847102),
            (Dissipation::ZhiyingQishao, 0.398837, 0.787365),
        ] {
            assert!((produced_restitution(law.factor(0.4)) - at_04).abs() < 1e-6, "{law:?} at 0.4");
            assert!((produced_restitution(law.factor(0.8)) - at_08).abs() < 1e-6, "{law:?} at 0.8");
        }
        assert_eq!(produced_restitution(0.0), 1.0);
    }
}
