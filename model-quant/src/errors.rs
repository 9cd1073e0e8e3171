//! How far found forces are from true ones: share of the variance explained, absolute errors, and what they are held against.
//!
//! R^2 is `1 - sum (truth - found)^2 / sum (truth - mean)^2`. The 99th percentile is that of the true forces' magnitude: a
//! full scale that one extreme row does not set. Forces in N; friction also as a torque on bench B's bearing radius.

use serde::Serialize;

/// Radius that friction forces become torques with, m: bench B's bearing. Its journal is thinner by the clearance, 1.5 mm at
/// most.
pub const FRICTION_RADIUS_M: f64 = 0.070;
/// The percentile that errors are held against.
const PERCENTILE: f64 = 0.99;

/// Errors over some rows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Errors {
    /// Rows.
    pub rows: usize,
    /// Share of the variance explained.
    pub r2: f64,
    /// Mean absolute error in N.
    pub mae_n: f64,
    /// Largest absolute error in N.
    pub largest_n: f64,
    /// 99th percentile of the true force's magnitude in N.
    pub p99_force_n: f64,
    /// Mean absolute error over that percentile.
    pub mae_share_of_p99: f64,
}

impl Errors {
    /// Errors of pairs of a true and a found force.
    pub fn of(pairs: impl Iterator<Item = (f64, f64)> + Clone) -> Self {
        let rows = pairs.clone().count();
        let count = rows.max(1) as f64;
        let centre = pairs.clone().map(|(truth, _)| truth).sum::<f64>() / count;
        let mut errors = Self { rows, ..Self::default() };
        let (mut residual, mut total, mut absolute) = (0.0, 0.0, 0.0);
        for (truth, found) in pairs.clone() {
            let error = (truth - found).abs();
            residual += error * error;
            total += (truth - centre) * (truth - centre);
            absolute += error;
            errors.largest_n = errors.largest_n.max(error);
        }
        let mut sizes: Vec<f64> = pairs.map(|(truth, _)| truth.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        let place = (PERCENTILE * sizes.len().saturating_sub(1) as f64).round() as usize;
        errors.r2 = 1.0 - residual / total;
        errors.mae_n = absolute / count;
        errors.p99_force_n = sizes.get(place).copied().unwrap_or(0.0);
        errors.mae_share_of_p99 = errors.mae_n / errors.p99_force_n;
        errors
    }

    /// Mean absolute error as a friction torque in N m.
    pub fn mae_nm(&self) -> f64 {
        self.mae_n * FRICTION_RADIUS_M
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_known_error_has_known_figures() {
        // 0, 1 .. 100 with an error of 1 at each, upwards and downwards in turn.
        let pairs = (0..=100).map(|i| (f64::from(i), f64::from(i) + if i % 2 == 0 { 1.0 } else { -1.0 }));
        let errors = Errors::of(pairs);
        assert_eq!((errors.rows, errors.mae_n, errors.largest_n, errors.p99_force_n), (101, 1.0, 1.0, 99.0));
        // The variance of 0..=100 is 100 * 102 / 12 = 850.
        assert!((errors.r2 - (1.0 - 1.0 / 850.0)).abs() < 1e-12);
        assert!((errors.mae_share_of_p99 - 1.0 / 99.0).abs() < 1e-15 && errors.mae_nm() == 0.07);
    }

    #[test]
    fn the_mean_explains_nothing_and_no_rows_are_no_error() {
        let none = Errors::of([(1.0, 2.0), (3.0, 2.0)].into_iter());
        assert_eq!(none.r2, 0.0);
        assert_eq!(Errors::of(core::iter::empty()).rows, 0);
    }
}
