//! Statistics of finite samples. Means and deviations come from `statrs`.
//!
//! A quantile here is a value of the sample. The quantiles of `statrs` lie between two values,
//! which would move the figures of the model cards.

use statrs::statistics::{Accumulate, OnlineMoments};

fn moments(values: impl IntoIterator<Item = f64>) -> OnlineMoments<2> {
    values.into_iter().fold(OnlineMoments::default(), OnlineMoments::push)
}

/// Mean; 0 without values.
pub(crate) fn mean(values: impl IntoIterator<Item = f64>) -> f64 {
    moments(values).mean().unwrap_or(0.0)
}

/// Mean and standard deviation of a complete population; both 0 without values.
pub(crate) fn mean_and_deviation(values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let moments = moments(values);
    [moments.mean(), moments.population_std_dev()].map(|value| value.unwrap_or(0.0))
}

/// Root mean square; 0 without values.
pub(crate) fn root_mean_square(values: impl IntoIterator<Item = f64>) -> f64 {
    mean(values.into_iter().map(|value| value * value)).sqrt()
}

/// Value of the sample nearest to a share of the sorted values, from 0 (smallest) to 1 (largest);
/// 0 without values. The values are reordered.
pub(crate) fn quantile(values: &mut [f64], share: f64) -> f64 {
    let rank = (share * values.len().saturating_sub(1) as f64).round() as usize;
    if rank >= values.len() {
        return 0.0;
    }
    *values.select_nth_unstable_by(rank, f64::total_cmp).1
}

/// Median, the upper one of an even number of values; 0 without values. The values are reordered.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    quantile(values, 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_values_have_known_statistics() {
        let values = [1.0, 2.0, 3.0, 6.0];
        assert_eq!(mean(values), 3.0);
        let [mean, deviation] = mean_and_deviation(values);
        assert!((mean - 3.0).abs() < 1e-15 && (deviation - 3.5_f64.sqrt()).abs() < 1e-15);
        assert!((root_mean_square(values) - 12.5_f64.sqrt()).abs() < 1e-15);
        assert_eq!(median(&mut [5.0, -1.0, 3.0]), 3.0);
        assert_eq!(median(&mut [4.0, 1.0, 3.0, 2.0]), 3.0, "the upper one of the two in the middle");
        let mut hundred: Vec<f64> = (0..=100).rev().map(f64::from).collect();
        assert_eq!([0.0, 0.99, 1.0].map(|share| quantile(&mut hundred, share)), [0.0, 99.0, 100.0]);
    }

    #[test]
    fn statistics_without_values_are_0() {
        assert_eq!(mean([]), 0.0);
        assert_eq!(mean_and_deviation([]), [0.0; 2]);
        assert_eq!(root_mean_square([]), 0.0);
        assert_eq!((median(&mut []), quantile(&mut [], 1.0)), (0.0, 0.0));
    }
}
