//! Estimates over cycles with 95 % intervals: a circular block bootstrap (D. N. Politis and J. P.
//! Romano, 1992) with expanded percentiles (T. C. Hesterberg, American Statistician 69, 2015).
//!
//! Blocks of `n^(1/3)` neighbouring cycles keep a dependence between neighbours. Percentiles of few
//! cycles are too narrow; they are expanded to the level at which the interval of a mean of normal
//! values is that of Student. Below [`MIN_CYCLES`] cycles there is no interval.

use super::samples::sorted_quantile;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use schemars::JsonSchema;
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// Fewest cycles of an interval.
pub(crate) const MIN_CYCLES: usize = 5;
/// Fewest cycles of an interval of a tail: a resampled value never exceeds the largest cycle, so
/// with few cycles an interval of a high quantile hardly covers.
pub(crate) const MIN_TAIL_CYCLES: usize = 30;
/// Number of resampled sequences.
const RESAMPLES: usize = 2000;
/// Probability on either side of the interval.
const SIDE: f64 = 0.025;

/// Estimate with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize)]
pub struct Estimate {
    /// Estimate from all cycles.
    pub value: f64,
    /// Lower and upper end of the interval; none with too few cycles.
    pub interval: Option<[f64; 2]>,
}

/// Estimates a statistic of the tail; without an interval below [`MIN_TAIL_CYCLES`].
pub(crate) fn estimate_tail(values: &[f64], seed: u64, statistic: impl Fn(&[f64]) -> f64) -> Estimate {
    if values.len() < MIN_TAIL_CYCLES {
        return Estimate { value: statistic(values), interval: None };
    }
    estimate(values, seed, statistic)
}

/// Estimates a statistic of the values of the cycles.
pub(crate) fn estimate(values: &[f64], seed: u64, statistic: impl Fn(&[f64]) -> f64) -> Estimate {
    let value = statistic(values);
    let count = values.len();
    if count < MIN_CYCLES {
        return Estimate { value, interval: None };
    }
    let block = (count as f64).cbrt().ceil() as usize;
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut resampled = Vec::with_capacity(count);
    let mut found: Vec<f64> = (0..RESAMPLES)
        .map(|_| {
            resampled.clear();
            while resampled.len() < count {
                let start = (rng.next_u64() % count as u64) as usize;
                let length = block.min(count - resampled.len());
                resampled.extend(values.iter().cycle().skip(start).take(length));
            }
            statistic(&resampled)
        })
        .collect();
    found.sort_by(f64::total_cmp);
    let side = expanded_side(count);
    Estimate { value, interval: Some([sorted_quantile(&found, side), sorted_quantile(&found, 1.0 - side)]) }
}

/// Probability on either side of a bootstrap distribution of `count` values.
fn expanded_side(count: usize) -> f64 {
    let freedom = count as f64 - 1.0;
    match (StudentsT::new(0.0, 1.0, freedom), Normal::new(0.0, 1.0)) {
        (Ok(student), Ok(normal)) => {
            normal.cdf(student.inverse_cdf(SIDE) * ((freedom + 1.0) / freedom).sqrt())
        }
        _ => SIDE,
    }
}

#[cfg(test)]
mod tests {
    use super::super::samples::{mean, quantile};
    use super::*;
    use rand_distr::{Distribution, StandardNormal};

    /// Share of sequences whose interval covers the true mean 0, for neighbours with a correlation.
    fn coverage(count: usize, correlation: f64) -> f64 {
        let runs = 1500;
        let covers = |seed: u64| {
            let mut rng = ChaCha8Rng::seed_from_u64(1000 + seed);
            let mut draw = || -> f64 { StandardNormal.sample(&mut rng) };
            let mut value = draw();
            let values: Vec<f64> = (0..count)
                .map(|_| {
                    value = correlation * value + (1.0 - correlation * correlation).sqrt() * draw();
                    value
                })
                .collect();
            estimate(&values, seed, |v| mean(v)).interval.is_some_and(|[low, high]| low <= 0.0 && 0.0 <= high)
        };
        (0..runs).filter(|&seed| covers(seed)).count() as f64 / runs as f64
    }

    #[test]
    fn intervals_of_independent_cycles_cover_nearly_as_often_as_stated() {
        for (count, expected) in [(6, 0.82..=0.88), (10, 0.85..=0.91), (40, 0.90..=0.95)] {
            let found = coverage(count, 0.0);
            eprintln!("{count} independent cycles: {found}");
            assert!(expected.contains(&found), "{count}: {found}");
        }
    }

    #[test]
    fn neighbours_that_resemble_each_other_cost_some_coverage() {
        let found = coverage(40, 0.5);
        eprintln!("40 cycles with correlation 0.5: {found}");
        assert!((0.80..=0.95).contains(&found), "{found}");
    }

    #[test]
    fn the_same_seed_gives_the_same_interval_and_few_cycles_give_none() {
        let values = [1.0, 3.0, 2.0, 5.0, 4.0, 2.5, 3.1, 1.7, 2.2, 4.4, 3.3, 2.9];
        assert_eq!(estimate(&values, 7, |v| mean(v)), estimate(&values, 7, |v| mean(v)));
        assert_ne!(estimate(&values, 7, |v| mean(v)).interval, estimate(&values, 8, |v| mean(v)).interval);
        assert_eq!(estimate(&values[..4], 7, |v| mean(v)), Estimate { value: 2.75, interval: None });
    }

    #[test]
    fn a_tail_has_an_interval_with_many_cycles_only() {
        let values: Vec<f64> = (0..40).map(|i| f64::from(i * 17 % 40)).collect();
        let high = |v: &[f64]| quantile(v, 0.9);
        assert!(estimate_tail(&values, 1, high).interval.is_some());
        assert_eq!(estimate_tail(&values[..29], 1, high).interval, None);
    }
}
