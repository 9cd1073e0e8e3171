//! Removal of outliers and noise from a measured signal.
//!
//! Outliers: Hampel filter. A value is replaced by the median of the 15 values around it if it
//! differs from that median by more than 5 robust standard deviations (1.4826 times the median
//! absolute deviation).
//!
//! Noise: Gaussian-weighted moving average, truncated at 3 standard deviations of the weights. Near
//! the ends the remaining weights are normalised to a sum of 1. For white noise and weights of `s`
//! samples the average leaves `1/sqrt(2 s sqrt(pi))` of the standard deviation: .17 at 10 samples.
//! A wide average also rounds the break-away peak: on the friction rig at 250 Hz, 2.5 samples (10
//! ms) are near the smallest error.

use super::statistics::median;

/// Values on either side of the median's window: 15 values in all.
const SIDE: usize = 7;
/// Distance from the median, in robust standard deviations, beyond which a value is an outlier.
const DEVIATIONS: f64 = 5.0;
/// Standard deviation of a normal distribution divided by its median absolute deviation.
const NORMAL: f64 = 1.4826;
/// Half-width of the average in standard deviations of its weights.
const REACH: f64 = 3.0;

/// Replaces outliers by the median around them; returns the signal and the number of outliers.
pub(crate) fn remove_outliers(signal: &[f64]) -> (Vec<f64>, usize) {
    let mut outliers = 0;
    let clean = signal.iter().enumerate().map(|(index, &value)| {
        let near = index.saturating_sub(SIDE)..(index + SIDE + 1).min(signal.len());
        let mut near = signal.get(near).unwrap_or_default().to_vec();
        let middle = median(&mut near);
        near.iter_mut().for_each(|value| *value = (*value - middle).abs());
        let limit = DEVIATIONS * NORMAL * median(&mut near);
        let far = (value - middle).abs() > limit;
        outliers += usize::from(far);
        if far { middle } else { value }
    });
    (clean.collect(), outliers)
}

/// Computes a Gaussian-weighted moving average; `deviation_samples` is the standard deviation of
/// the weights and must be above 0.
pub(crate) fn smooth(signal: &[f64], deviation_samples: f64) -> Vec<f64> {
    let reach = (REACH * deviation_samples).ceil() as usize;
    let weights: Vec<f64> =
        (0..=reach).map(|k| (-0.5 * (k as f64 / deviation_samples).powi(2)).exp()).collect();
    (0..signal.len())
        .map(|index| {
            let first = index.saturating_sub(reach);
            let near = signal.get(first..(index + reach + 1).min(signal.len())).unwrap_or_default();
            let (mut sum, mut all) = (0.0, 0.0);
            for (place, value) in (first..).zip(near) {
                let weight = weights.get(place.abs_diff(index)).copied().unwrap_or_default();
                sum += weight * value;
                all += weight;
            }
            sum / all
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::draw::{Draw, Purpose};
    use crate::data::statistics::root_mean_square;
    use proptest::prelude::*;

    #[test]
    fn noise_falls_by_the_theoretical_factor_and_outliers_are_removed() {
        let mut draw = Draw::new(1, Purpose::DatasetSamples, 0);
        let noise: Vec<f64> = (0..20_000).map(|_| draw.normal()).collect();
        let expected = 1.0 / (2.0 * 10.0 * core::f64::consts::PI.sqrt()).sqrt();
        let found = root_mean_square(smooth(&noise, 10.0));
        assert!((found / expected - 1.0).abs() < 0.06, "{found} {expected}");

        let mut signal = noise;
        for index in (50..20_000).step_by(100) {
            signal[index] += if index % 200 == 50 { 40.0 } else { -40.0 };
        }
        let (clean, outliers) = remove_outliers(&signal);
        assert!((200..500).contains(&outliers), "{outliers}");
        assert!(clean.iter().all(|v| v.abs() < 6.0));
    }

    #[test]
    fn a_step_and_a_constant_are_no_outliers() {
        let step: Vec<f64> = (0..200).map(|i| f64::from(i >= 100) + 0.01 * f64::from(i % 3)).collect();
        assert_eq!(remove_outliers(&step).1, 0);
        assert_eq!(remove_outliers(&[2.5; 40]), (vec![2.5; 40], 0));
        assert_eq!(remove_outliers(&[]), (vec![], 0));
    }

    proptest! {
        #[test]
        fn an_average_keeps_constants_and_lines_inside_and_stays_between_the_extremes(
            level in -1e3..1e3f64, slope in -10.0..10.0f64, deviation in 0.3..20.0f64,
        ) {
            let line: Vec<f64> = (0..200).map(|i| level + slope * f64::from(i)).collect();
            let found = smooth(&line, deviation);
            for (a, b) in found.iter().zip(&line).skip(60).take(80) {
                prop_assert!((a - b).abs() < 1e-8 * (1.0 + b.abs()));
            }
            let (low, high) = (line[0].min(line[199]), line[0].max(line[199]));
            prop_assert!(found.iter().all(|v| (low - 1e-6..=high + 1e-6).contains(v)));
        }
    }
}
