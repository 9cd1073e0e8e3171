//! Inverse of the curve `y = u (1 - ln u)` on 0..1: the shape of every logarithmic law, see
//! `logarithmic`.
//!
//! Dimensionless. The curve rises from 0 to 1 and is flat at 1, so near 1 half of the digits of `u`
//! are lost, as in any law with such an end.

use crate::real::Real;

/// Steps of the search; after that many halvings the bracket is a single number.
const SEARCH_STEPS: u32 = 120;

/// Returns the root `u` of `u (1 - ln u) = y` for `0 < y < 1`.
///
/// Bracket: `u` is above `1 - sqrt(2(1-y))`, as the curve is below its parabola at 1, and below
/// `y/(1 - ln y)`, as `u < y`. The curve is concave: Newton's steps cannot cycle, and a step that
/// leaves the bracket is replaced by its middle.
pub(crate) fn share_at<T: Real>(y: T, start: T) -> T {
    let mut low = (T::ONE - (T::from_f64(2.0) * (T::ONE - y)).sqrt()).max(T::ZERO);
    let mut high = (y / (T::ONE - y.ln())).min(T::ONE);
    let mut u = if start > low && start < high { start } else { high };
    for _ in 0..SEARCH_STEPS {
        let logarithm = u.ln();
        let residual = u * (T::ONE - logarithm) - y;
        if residual > T::ZERO {
            high = u;
        } else {
            low = u;
        }
        let mut next = u + residual / logarithm;
        if !(next > low && next < high) {
            next = T::from_f64(0.5) * (low + high);
        }
        if (next - u).abs() <= T::EPSILON * u {
            return next;
        }
        u = next;
    }
    u
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn it_holds_at_both_ends() {
        for y in [1e-300, 1e-30, 1e-3, 0.5, 0.999, 1.0 - 1e-15] {
            let u: f64 = share_at(y, 0.0);
            assert!((u * (1.0 - u.ln()) / y - 1.0).abs() < 1e-14, "{y}: {u}");
        }
    }

    proptest! {
        #[test]
        fn any_start_leads_to_the_same_root(exponent in -12.0..0.0_f64, start in -1.0..2.0_f64) {
            let y = 10_f64.powf(exponent).min(0.999);
            prop_assert!((share_at(y, start) / share_at(y, 0.0) - 1.0).abs() < 1e-12);
        }

        #[test]
        fn single_precision_solves_it_too(exponent in -6.0..-0.01_f32) {
            let y = 10_f32.powf(exponent);
            let u = share_at(y, 0.0);
            prop_assert!((u * (1.0 - u.ln()) / y - 1.0).abs() < 1e-6);
        }
    }
}
