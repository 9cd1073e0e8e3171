//! Outliers and noise taken out of a measured signal.
//!
//! Outliers: a value further from the median of the 15 around it than 5 times their robust deviation (1.4826 times the median
//! distance from the median, Hampel) is replaced by that median. Noise: a Gaussian-weighted moving average, cut off at 3
//! standard deviations of the weight; beside the ends the weights that are left are brought to a sum of 1. For white noise at
//! a weight of `s` samples the average leaves `1/sqrt(2 s sqrt(pi))` of its standard deviation: .17 at 10 samples.
//! A wide average rounds the break-away off, too: on the friction rig at 250 Hz 2.5 samples (10 ms) are near the least error.

/// Values on either side that a median is taken over.
const SIDE: usize = 7;
/// Robust deviations that a value may lie away.
const DEVIATIONS: f64 = 5.0;
/// Standard deviation of a normal distribution over its median distance from the median.
const NORMAL: f64 = 1.4826;
/// Standard deviations that the weights reach.
const REACH: f64 = 3.0;

/// A signal without outliers, and how many there were.
pub fn without_outliers(signal: &[f64]) -> (Vec<f64>, usize) {
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

/// The Gaussian-weighted moving average with a standard deviation of the weights in samples, above 0.
pub fn smoothed(signal: &[f64], deviation_samples: f64) -> Vec<f64> {
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

fn median(values: &mut [f64]) -> f64 {
    let middle = values.len() / 2;
    if middle >= values.len() {
        return 0.0;
    }
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::{Draw, Purpose};
    use proptest::prelude::*;

    #[test]
    fn noise_is_lowered_as_theory_says_and_outliers_go() {
        let mut draw = Draw::new(1, Purpose::DatasetSamples, 0);
        let noise: Vec<f64> = (0..20_000).map(|_| draw.normal()).collect();
        let rms = |signal: &[f64]| (signal.iter().map(|v| v * v).sum::<f64>() / signal.len() as f64).sqrt();
        let expected = 1.0 / (2.0 * 10.0 * core::f64::consts::PI.sqrt()).sqrt();
        let found = rms(&smoothed(&noise, 10.0));
        assert!((found / expected - 1.0).abs() < 0.06, "{found} {expected}");

        let mut signal = noise;
        for index in (50..20_000).step_by(100) {
            signal[index] += if index % 200 == 50 { 40.0 } else { -40.0 };
        }
        let (clean, outliers) = without_outliers(&signal);
        assert!((200..500).contains(&outliers), "{outliers}");
        assert!(clean.iter().all(|v| v.abs() < 6.0));
    }

    #[test]
    fn a_step_and_a_constant_are_no_outliers() {
        let step: Vec<f64> = (0..200).map(|i| f64::from(i >= 100) + 0.01 * f64::from(i % 3)).collect();
        assert_eq!(without_outliers(&step).1, 0);
        assert_eq!(without_outliers(&[2.5; 40]), (vec![2.5; 40], 0));
        assert_eq!(without_outliers(&[]), (vec![], 0));
    }

    proptest! {
        #[test]
        fn an_average_keeps_constants_and_lines_inside_and_stays_between_the_extremes(
            level in -1e3..1e3f64, slope in -10.0..10.0f64, deviation in 0.3..20.0f64,
        ) {
            let line: Vec<f64> = (0..200).map(|i| level + slope * f64::from(i)).collect();
            let smooth = smoothed(&line, deviation);
            for (a, b) in smooth.iter().zip(&line).skip(60).take(80) {
                prop_assert!((a - b).abs() < 1e-8 * (1.0 + b.abs()));
            }
            let (low, high) = (line[0].min(line[199]), line[0].max(line[199]));
            prop_assert!(smooth.iter().all(|v| (low - 1e-6..=high + 1e-6).contains(v)));
        }
    }
}
