//! Forces of the networks over those of the described law.

use super::arithmetic::smaller;
use crate::integrity::words;

/// Coefficient of friction at which half of the networks' difference from the law is taken.
const BLENDED_COEFFICIENT: f32 = 0.01;
/// Limits of a ratio. Networks beyond are not those of this bearing.
const RANGE: (f32, f32) = (0.5, 2.0);

/// Forces of the networks over those of the described law, at the same contact.
///
/// The absolute error of a network does not vanish with the force. The ratio therefore tends to 1
/// for forces far below the end of the training range: `1 + (network - law)/(law + blend)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ratios {
    /// Ratio of the normal forces.
    pub(super) normal: f32,
    /// Ratio of the coefficients of friction.
    pub(super) friction: f32,
}
words!(Ratios { normal, friction });

impl Ratios {
    /// The described law.
    pub(super) const LAW: Self = Self { normal: 1.0, friction: 1.0 };

    /// Compares normal forces in N, 0 or more, and coefficients of friction without sign. `blend`
    /// is the force in N at which half of the difference is taken; above 0.
    pub(super) fn new(normal: [f32; 2], coefficients: [f32; 2], blend: f32) -> Self {
        Self { normal: ratio(normal, blend), friction: ratio(coefficients, BLENDED_COEFFICIENT) }
    }
}

/// Returns the blended ratio of a network's value to the law's.
fn ratio([network, law]: [f32; 2], blend: f32) -> f32 {
    let (low, high) = RANGE;
    let ratio = 1.0 + (network - law) * (1.0 / (law + blend));
    // Not a number becomes the lower end.
    smaller(if ratio > low { ratio } else { low }, high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ratio_is_that_of_large_forces_and_1_for_small_ones() {
        let ratios = Ratios::new([11_000.0, 10_000.0], [0.18, 0.2], 100.0);
        assert!((ratios.normal - 1.1).abs() < 2e-3 && (ratios.friction - 0.9).abs() < 6e-3, "{ratios:?}");
        let light = Ratios::new([2.0, 1.0], [0.0, 0.0], 100.0);
        assert!((light.normal - 1.0).abs() < 0.011 && light.friction == 1.0, "{light:?}");
    }

    #[test]
    fn impossible_values_end_at_the_limits() {
        for network in [f32::INFINITY, f32::NAN, -1e9, 1e9] {
            let ratio = Ratios::new([network, 1000.0], [network, 0.2], 100.0);
            assert!(
                (0.5..=2.0).contains(&ratio.normal) && (0.5..=2.0).contains(&ratio.friction),
                "{network}"
            );
        }
    }
}
