//! Numerical error bars of the quantities of a run, from three runs of rising accuracy.
//!
//! The finest run gives the value. With `a` the change from the coarse run to the middle one and
//! `b` that from the middle run to the finest, errors that fall by a constant factor `q` from run
//! to run leave `|b| q/(1 - q)` in the value: Richardson's extrapolation with the observed order of
//! convergence, as in the grid convergence index (Roache, "Quantification of uncertainty in
//! computational fluid dynamics", 1997). Three deviations from it make the bar cover the error:
//!
//! * `q` is the median of `|b|/|a|` over all quantities of the run, because a single ratio is a
//!   matter of chance where located contacts make the convergence irregular.
//! * `|b|` is at least `q |a|`: two runs may agree by chance.
//! * `q/(1 - q)` is at least 1, because errors at tight tolerances fall more slowly than the two
//!   changes suggest, and the product is multiplied by [`SAFETY`].
//!
//! Against references at much tighter tolerances the bars cover at least 95 % of the peaks
//! (`tests/error_bars.rs`). The model's errors are not included.

use crate::statistics::median;

/// Safety factor on the extrapolated error.
const SAFETY: f64 = 2.0;
/// Safety factor on the change from the middle run if there is no coarse one.
const SAFETY_OF_TWO_RUNS: f64 = 3.0;
/// Largest ratio of successive changes that is extrapolated: slower convergence is not regular.
const MAX_RATIO: f64 = 2.0 / 3.0;

/// A quantity in the finest, the middle and the coarse run; `None` where the run does not have it.
pub(super) type Convergence = (f64, Option<f64>, Option<f64>);

/// Returns the error bar of every quantity of the finest run; infinite if the middle run does not
/// have it.
pub(super) fn error_bars(quantities: &[Convergence]) -> Vec<f64> {
    let changes = |&(fine, middle, coarse): &Convergence| {
        let middle = middle?;
        Some(((fine - middle).abs(), coarse.map(|coarse| (middle - coarse).abs())))
    };
    let ratio = |(last, first): (f64, Option<f64>)| Some(last / first.filter(|&first| first > 0.0)?);
    let ratios = quantities.iter().filter_map(changes).filter_map(ratio);
    let observed = median(ratios).map(|q| q.min(MAX_RATIO));
    let bar = |(last, first): (f64, Option<f64>)| match observed.zip(first) {
        Some((q, first)) => SAFETY * last.max(q * first) * (q / (1.0 - q)).max(1.0),
        None => SAFETY_OF_TWO_RUNS * last,
    };
    quantities.iter().map(|quantity| changes(quantity).map_or(f64::INFINITY, bar)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors that halve from run to run leave as much as the last change; those that fall to a
    /// tenth leave a ninth, and the bar stays at the last change.
    #[test]
    fn the_bar_follows_the_observed_order_and_never_falls_below_the_last_change() {
        let series = |q: f64, error: f64| {
            let middle = error / q;
            (10.0 + error, Some(10.0 + middle), Some(10.0 + middle / q))
        };
        for (q, factor) in [(0.6, 1.0), (0.5, 1.0), (0.1, 0.9 / 0.1)] {
            let error = 1e-3;
            for bar in error_bars(&[series(q, error), series(q, error)]) {
                assert!((bar / (SAFETY * factor * error) - 1.0).abs() < 1e-9, "{bar} for {q}");
            }
        }
    }

    #[test]
    fn an_agreement_by_chance_does_not_shrink_a_bar() {
        let regular = (1.0, Some(1.5), Some(2.5));
        let chance = (1.0, Some(1.0), Some(2.0));
        let bars = error_bars(&[regular, regular, chance]);
        assert_eq!(bars, [1.0, 1.0, 1.0]);
    }

    #[test]
    fn a_missing_run_widens_the_bar_and_a_missing_middle_run_leaves_none() {
        let bars = error_bars(&[(1.0, Some(1.1), None), (1.0, None, Some(1.1))]);
        assert!((bars[0] - 0.3).abs() < 1e-12 && bars[1].is_infinite(), "{bars:?}");
        // Changes that grow do not converge: the factor ends at 2.
        let diverging = error_bars(&[(1.0, Some(2.0), Some(2.5))]);
        assert!((diverging[0] - SAFETY * 2.0).abs() < 1e-9, "{diverging:?}");
    }
}
