//! Exact relation between the dissipation factor and the restitution of a free impact.
//!
//! `F = F_el(d) (1 + chi d'/d'0)` rebounds with the restitution `e` that solves `chi (1 + e) =
//! ln((1 + chi)/(1 - chi e))`, for every stiffness, exponent, mass and approach speed. Derivation:
//! separate the variables in `m v dv/dx = -F_el (1 + chi v/v0)`; approach and rebound have the same
//! elastic work. Every published factor approximates this relation; [`exact_factor`] inverts it.
//! Both are computed in double precision.

use libm::{log, log1p, sqrt};

/// Limit below which cancellation makes the relation inaccurate, and above a restitution of `1 -
/// SERIES_BELOW`. There its series is used: `(1 - e^2)/2 - chi (1 + e^3)/3 + chi^2 (1 - e^4)/4 -
/// chi^3 (1 + e^5)/5 = 0`, accurate to 1e-11.
const SERIES_BELOW: f64 = 1e-3;

/// Steps of the bracketed searches: more than enough to halve the bracket to neighbouring numbers.
const SEARCH_STEPS: u32 = 100;

/// Terms of the series that are small compared with the first two.
fn higher_terms(factor: f64, e: f64) -> f64 {
    let square = e * e;
    factor * factor * (1.0 - square * square) / 4.0
        - factor * factor * factor * (1.0 + square * square * e) / 5.0
}

/// Returns the restitution that a law `F_el(d) (1 + chi d'/d'0)` produces in a free impact, for
/// every stiffness, exponent, mass and approach speed.
///
/// Solves `chi (1 + e) = ln((1 + chi)/(1 - chi e))` for its positive root by bisection; 1 for `chi
/// <= 0`.
pub(crate) fn from_factor(factor: f64) -> f64 {
    if factor <= 0.0 {
        return 1.0;
    }
    if factor < SERIES_BELOW {
        let mut e = 1.0;
        for _ in 0..8 {
            let square = 1.0 + 2.0 * (higher_terms(factor, e) - factor * (1.0 + e * e * e) / 3.0);
            e = sqrt(square);
        }
        return e;
    }
    let residual = |e: f64| factor * (1.0 + e) - log((1.0 + factor) / (1.0 - factor * e));
    // The residual is positive below the root, and tends to minus infinity at e = 1/chi.
    let mut low = 0.0;
    let mut high = if factor > 1.0 { 1.0 / factor } else { 1.0 };
    for _ in 0..SEARCH_STEPS {
        let middle = 0.5 * (low + high);
        if residual(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Returns the factor that produces a restitution exactly; 0 at 1 and above, infinite at 0 and
/// below.
///
/// Newton's method from a close start (Carvalho and Martins' factor) inside a bracket: the residual
/// is positive below the root and tends to minus infinity at `chi = 1/e`.
pub(crate) fn exact_factor(restitution: f64) -> f64 {
    let e = restitution;
    if e >= 1.0 {
        return 0.0;
    }
    if e <= 0.0 {
        return f64::INFINITY;
    }
    let mut factor = 1.5 * (1.0 - e) * (11.0 - e) / (1.0 + 9.0 * e);
    if e > 1.0 - SERIES_BELOW {
        for _ in 0..8 {
            factor = 3.0 * ((1.0 - e * e) / 2.0 + higher_terms(factor, e)) / (1.0 + e * e * e);
        }
        return factor;
    }
    let (mut low, mut high) = (0.0, 1.0 / e);
    for _ in 0..SEARCH_STEPS {
        if !(factor > low && factor < high) {
            factor = 0.5 * (low + high);
        }
        let residual = factor * (1.0 + e) - log1p(factor) + log1p(-factor * e);
        if residual > 0.0 {
            low = factor;
        } else {
            high = factor;
        }
        let slope = (1.0 + e) - 1.0 / (1.0 + factor) - e / (1.0 - factor * e);
        let next = factor - residual / slope;
        if libm::fabs(next - factor) <= 2.0 * f64::EPSILON * factor || high - low <= f64::EPSILON * high {
            break;
        }
        factor = next;
    }
    // At a small restitution the root is closer to 1/e than two neighbouring numbers: the lower one
    // is used.
    factor.clamp(low, high).min((1.0 - f64::EPSILON) / e)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn series_and_search_agree() {
        for factor in [0.999e-3, 1.001e-3] {
            let e = from_factor(factor);
            // First-order inverse of the relation: e = 1 - 2 chi/3 + 4 chi^2/9.
            assert!((e - (1.0 - 2.0 / 3.0 * factor + 4.0 / 9.0 * factor * factor)).abs() < 2e-9, "{e}");
        }
        assert!((exact_factor(0.999 - 1e-9) / exact_factor(0.999 + 1e-9) - 1.0 - 2e-6).abs() < 1e-8);
    }

    #[test]
    fn the_ends_of_the_range_are_exact() {
        assert_eq!(from_factor(0.0), 1.0);
        assert_eq!(exact_factor(1.0), 0.0);
        assert_eq!(exact_factor(0.0), f64::INFINITY);
    }

    proptest! {
        #[test]
        fn the_exact_factor_inverts_the_produced_restitution(e in 0.02..1.0_f64) {
            prop_assert!((from_factor(exact_factor(e)) - e).abs() < 1e-9, "{}", from_factor(exact_factor(e)));
        }

        #[test]
        fn nearly_elastic_impacts_keep_their_digits(loss in 1e-9..1e-2_f64) {
            let e = 1.0 - loss;
            prop_assert!(((1.0 - from_factor(exact_factor(e))) / loss - 1.0).abs() < 1e-6);
        }
    }
}
