//! Robust and other statistics that several modules use, beside those of [`bench::statistics`].

/// Standard deviations of a normal distribution in its median absolute value: 1/0.67449.
const SIGMAS_PER_MEDIAN: f64 = 1.4826;

/// Sum of the squared deviations from `mean`.
pub(crate) fn square_deviations(values: &[f64], mean: f64) -> f64 {
    values.iter().map(|v| (v - mean).powi(2)).sum()
}

/// Median of the finite values (the upper of two); 0 without values.
pub(crate) fn median(values: impl Iterator<Item = f64>) -> f64 {
    bench::statistics::median(values.filter(|v| v.is_finite())).unwrap_or_default()
}

/// Lower quartile: the value with a quarter of the others below it; `None` without values.
pub(crate) fn lower_quartile(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len().checked_sub(1)? / 4).copied()
}

/// Standard deviation of normally distributed values around 0, from their median absolute value.
pub(crate) fn robust_deviation(values: impl Iterator<Item = f64>) -> f64 {
    SIGMAS_PER_MEDIAN * median(values.map(f64::abs))
}

/// Slope of a line through the origin with the smallest sum of absolute errors: the median of
/// `y/x`, weighted by `|x|`. `None` if every `x` is 0.
pub(crate) fn robust_slope(x: &[f64], y: &[f64]) -> Option<f64> {
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

/// Largest minus smallest value; 0 without values.
pub(crate) fn range(values: &[f64]) -> f64 {
    let (low, high) = limits(values.iter().copied());
    if low <= high { high - low } else { 0.0 }
}

/// Smallest and largest value; infinite of opposite signs without values.
pub(crate) fn limits(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_outliers_do_not_change_robust_statistics() {
        assert_eq!(median([4.0, f64::NAN, 1.0, 1e9, 2.0].into_iter()), 4.0);
        assert_eq!(lower_quartile(vec![5.0, 1.0, 4.0, 2.0, 1e9]), Some(2.0));
        assert_eq!(robust_slope(&[0.0, 1.0, 2.0, 3.0], &[7.0, -100.0, 4.0, 6.0]), Some(2.0));
        let spread = robust_deviation([-1.0, 1.0, -1.0, 1.0, 1e9].into_iter());
        assert!((spread - 1.4826).abs() < 1e-12, "{spread}");
    }

    #[test]
    fn no_values_have_no_statistics() {
        let none = || std::iter::empty::<f64>();
        assert_eq!((median(none()), robust_deviation(none()), range(&[])), (0.0, 0.0, 0.0));
        assert_eq!((lower_quartile(vec![]), robust_slope(&[0.0], &[1.0])), (None, None));
    }
}
