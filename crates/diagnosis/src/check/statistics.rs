//! Statistics that a few wrong readings do not move.

/// Standard deviations of a normal distribution in its median absolute value.
const NORMAL: f64 = 1.4826;

/// The middle value; 0 of nothing.
pub(super) fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.filter(|v| v.is_finite()).collect();
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Standard deviation from the median absolute value of what scatters around 0.
pub(super) fn scatter(values: impl Iterator<Item = f64>) -> f64 {
    NORMAL * median(values.map(f64::abs))
}

/// The slope through the origin that makes the sum of absolute deviations least: the median of `y/x`, weighted by `|x|`.
pub(super) fn slope(x: &[f64], y: &[f64]) -> Option<f64> {
    let mut ratios: Vec<(f64, f64)> =
        x.iter().zip(y).filter(|(x, _)| **x != 0.0).map(|(x, y)| (y / x, x.abs())).collect();
    ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = 0.5 * ratios.iter().map(|r| r.1).sum::<f64>();
    let mut sum = 0.0;
    ratios.into_iter().find_map(|(ratio, weight)| {
        sum += weight;
        (sum >= half).then_some(ratio)
    })
}

/// Largest less smallest.
pub(super) fn range(values: &[f64]) -> f64 {
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &v| (a.min(v), b.max(v)));
    if low <= high { high - low } else { 0.0 }
}

/// Runs of equal readings, as first index and length.
pub(super) fn runs(values: &[f64]) -> impl Iterator<Item = (usize, usize)> + '_ {
    let mut start = 0;
    values.chunk_by(|a, b| a == b).map(move |run| {
        start += run.len();
        (start - run.len(), run.len())
    })
}
