//! Length of the transient of a sequence of cycles: the MSER rule (K. P. White, Simulation 69,
//! 1997), with a resolution.
//!
//! The transient ends at the cycle `d` that minimises `(s^2 + (0.01 m)^2)/(n - d)`, with mean `m`
//! and variance `s^2` of the `n - d` cycles that remain. Without the resolution of 1 %, a sequence
//! that converges to a periodic motion would lose cycles as long as it converges at all.

use super::samples::mean;

/// Differences below this share of the mean count as none.
const RESOLUTION: f64 = 1e-2;

/// Number of cycles of the transient, at most half of them, and whether the sequence has settled:
/// false if the minimum lies at that limit, so that a longer run might cut more.
pub(crate) fn transient_length(values: &[f64]) -> (usize, bool) {
    let limit = values.len() / 2;
    let criterion = |d: usize| {
        let rest = values.get(d..).unwrap_or_default();
        let count = rest.len() as f64;
        let mean = mean(rest);
        let variance = rest.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / count;
        (variance + (RESOLUTION * mean).powi(2)) / count
    };
    let best = (0..=limit).min_by(|&a, &b| criterion(a).total_cmp(&criterion(b))).unwrap_or_default();
    (best, best < limit || best == 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_transient_is_cut_where_the_scatter_begins() {
        let scatter = |i: usize| [0.3, -0.4, 0.1, 0.2, -0.2, 0.0][i % 6];
        let values: Vec<f64> = (0..30).map(|i| 10.0 + scatter(i) + 8.0 * (-(i as f64) / 1.5).exp()).collect();
        let (cut, is_settled) = transient_length(&values);
        assert!((3..=7).contains(&cut) && is_settled, "{cut}");
        let settled: Vec<f64> = (0..30).map(|i| 10.0 + scatter(i)).collect();
        assert!(transient_length(&settled).1);
    }

    #[test]
    fn convergence_below_the_resolution_cuts_nothing_more() {
        let values: Vec<f64> = (0..12).map(|i| 100.0 + 20.0 * 0.01_f64.powi(i)).collect();
        // The second cycle differs by 0.2 %, the third by 0.002 %.
        let (cut, is_settled) = transient_length(&values);
        assert!(cut == 1 && is_settled, "{cut}");
    }

    #[test]
    fn a_drift_to_the_end_is_not_settled() {
        let values: Vec<f64> = (0..20).map(|i| 100.0 + f64::from(i)).collect();
        assert_eq!(transient_length(&values), (10, false));
    }
}
