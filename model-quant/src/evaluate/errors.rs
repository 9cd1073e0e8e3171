//! Error statistics of forces: R^2, absolute errors, and the full scale that they are compared
//! with.
//!
//! R^2 is `1 - sum (truth - found)^2 / sum (truth - mean)^2`. The full scale is the 99th percentile
//! of the true forces' magnitude, which a single extreme row does not determine. Forces are in N;
//! friction also as a torque on bench B's bearing radius.

use crate::data::statistics::{mean, mean_and_deviation, quantile, root_mean_square};
use serde::Serialize;

/// Radius in m that converts friction forces to torques: bench B's bearing. Its journal is smaller
/// by the clearance, at most 1.5 mm.
pub(crate) const FRICTION_RADIUS_M: f64 = 0.070;
/// Share of the rows whose true force is at most the full scale.
const FULL_SCALE_SHARE: f64 = 0.99;

/// Errors over a set of rows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Errors {
    /// Number of rows.
    pub rows: usize,
    /// Share of the variance that is explained (R^2).
    pub r2: f64,
    /// Mean absolute error in N.
    pub mae_n: f64,
    /// Largest absolute error in N.
    pub largest_n: f64,
    /// 99th percentile of the true force's magnitude in N.
    pub p99_force_n: f64,
    /// Mean absolute error divided by that percentile.
    pub mae_share_of_p99: f64,
}

impl Errors {
    /// Computes the errors of pairs of true and estimated force.
    pub(crate) fn from_pairs(pairs: impl Iterator<Item = (f64, f64)> + Clone) -> Self {
        let errors = || pairs.clone().map(|(truth, found)| (truth - found).abs());
        let [_, deviation] = mean_and_deviation(pairs.clone().map(|(truth, _)| truth));
        let mut forces: Vec<f64> = pairs.clone().map(|(truth, _)| truth.abs()).collect();
        let (mae_n, p99_force_n) = (mean(errors()), quantile(&mut forces, FULL_SCALE_SHARE));
        Self {
            rows: forces.len(),
            r2: 1.0 - (root_mean_square(errors()) / deviation).powi(2),
            mae_n,
            largest_n: errors().fold(0.0, f64::max),
            p99_force_n,
            mae_share_of_p99: mae_n / p99_force_n,
        }
    }

    /// Mean absolute error as a friction torque in N m.
    pub(crate) fn mae_nm(&self) -> f64 {
        self.mae_n * FRICTION_RADIUS_M
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_known_error_has_known_figures() {
        // 0, 1 .. 100 with errors of alternately +1 and -1.
        let pairs = (0..=100).map(|i| (f64::from(i), f64::from(i) + if i % 2 == 0 { 1.0 } else { -1.0 }));
        let errors = Errors::from_pairs(pairs);
        assert_eq!((errors.rows, errors.mae_n, errors.largest_n, errors.p99_force_n), (101, 1.0, 1.0, 99.0));
        // The variance of 0..=100 is 100 * 102 / 12 = 850.
        assert!((errors.r2 - (1.0 - 1.0 / 850.0)).abs() < 1e-12);
        assert!((errors.mae_share_of_p99 - 1.0 / 99.0).abs() < 1e-15 && errors.mae_nm() == 0.07);
    }

    #[test]
    fn the_mean_has_an_r2_of_0_and_an_empty_set_has_no_errors() {
        let none = Errors::from_pairs([(1.0, 2.0), (3.0, 2.0)].into_iter());
        assert_eq!(none.r2, 0.0);
        assert_eq!(Errors::from_pairs(core::iter::empty()).rows, 0);
    }
}
