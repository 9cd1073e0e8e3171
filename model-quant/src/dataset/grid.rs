//! The axes of the paper's Table 2: 15 clearances, 100 deformations, 100 rates, 100 latched rates.
//!
//! The paper gives a number of samples for every parameter and a total of 1.5e7, which is the product of the four: so
//! the values are drawn axis by axis, and the set is all their combinations. Each axis is stratified: value `j` of `n`
//! is the quantile of its distribution at a uniform draw between `j/n` and `(j+1)/n`, so that 15 clearances cover 0 to
//! 1.5 mm and do not leave a third of it out by chance. Clearances are uniform and not below the range's lowest (1 um; at
//! 0 the law has no clearance to speak of). The other three are exponential with a mean of a fifth of the range, which
//! the paper does not give, cut off at its end. Both bearings have the same axes for the same seed. Values in m and
//! m/s, as f32.

use crate::draw::{Draw, Purpose};
use crate::features::FloatFeatures;
use libm::{exp, log};

/// Values of every axis in Table 2.
pub const COUNTS: [u64; 4] = [15, 100, 100, 100];
/// Rows of the whole set.
pub const ROWS: u64 = 15_000_000;
/// Upper end of rate and latched rate in m/s.
const RATE_HIGH_M_S: f64 = 1.0;
/// Range over mean of the exponential distributions.
const MEANS: f64 = 5.0;

/// The values of the four axes: clearance, deformation, rate, latched rate.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    axes: [Vec<f32>; 4],
}

/// Quantile at `probability` of the exponential distribution that is cut off at `high`.
fn exponential(high: f64, probability: f64) -> f64 {
    -high / MEANS * log(1.0 - (1.0 - exp(-MEANS)) * probability)
}

impl Grid {
    /// The axes of a seed over the ranges of `features`.
    pub fn draw(features: &FloatFeatures, seed: u64) -> Self {
        let deformation_high = f64::from(features.deformation_m.high);
        let clearance = features.radial_clearance_m;
        let quantile = |axis: usize, probability: f64| match axis {
            0 => f64::from(clearance.clamp((f64::from(clearance.high) * probability) as f32)),
            1 => exponential(deformation_high, probability),
            _ => exponential(RATE_HIGH_M_S, probability),
        };
        let axes = core::array::from_fn(|axis| {
            let count = COUNTS.get(axis).copied().unwrap_or_default();
            let mut draw = Draw::new(seed, Purpose::DatasetAxes, axis as u64);
            (0..count).map(|j| quantile(axis, (j as f64 + draw.unit()) / count as f64) as f32).collect()
        });
        Self { axes }
    }

    /// The four axes.
    pub fn axes(&self) -> &[Vec<f32>; 4] {
        &self.axes
    }

    /// Index of the clearance and the four values at a point of the grid; points beyond the last begin anew.
    pub fn at(&self, point: u64) -> (usize, [f32; 4]) {
        let mut rest = point;
        let mut values = [0.0; 4];
        let mut index = 0;
        for (axis, value) in self.axes.iter().zip(&mut values).rev() {
            let count = axis.len().max(1) as u64;
            index = (rest % count) as usize;
            *value = axis.get(index).copied().unwrap_or_default();
            rest /= count;
        }
        (index, values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ranges::{RangeKind, header};
    use inference::Bearing;

    fn grid(seed: u64) -> Grid {
        Grid::draw(&FloatFeatures::of(&header(Bearing::Babbitt, RangeKind::Paper)), seed)
    }

    #[test]
    fn the_axes_have_the_means_and_quantiles_of_their_distributions() {
        let grid = grid(3);
        let [clearance, deformation, rate, latched] = grid.axes();
        assert_eq!(ROWS, COUNTS.iter().product::<u64>());
        let mean = |axis: &[f32]| axis.iter().map(|&v| f64::from(v)).sum::<f64>() / axis.len() as f64;
        assert!((mean(clearance) / 0.75e-3 - 1.0).abs() < 0.03, "{}", mean(clearance));
        // Mean of the cut exponential over its range: 1/5 - 1/(e^5 - 1).
        let expected = 0.2 - 1.0 / (5.0_f64.exp() - 1.0);
        for (axis, high) in [(deformation, 1e-4), (rate, 1.0), (latched, 1.0)] {
            assert!((mean(axis) / (high * expected) - 1.0).abs() < 0.01, "{}", mean(axis));
            assert!(axis.windows(2).all(|w| w[0] < w[1]));
            assert!(axis[0] > 0.0 && f64::from(axis[99]) < high);
            // Stratified: the value between the 50th and the 51st stratum is the median.
            let median = -high / 5.0 * (1.0 - 0.5 * (1.0 - (-5.0_f64).exp())).ln();
            assert!(f64::from(axis[49]) <= median && median <= f64::from(axis[50]));
        }
        assert_ne!(rate, latched);
        assert_ne!(grid, super::tests::grid(4));
    }

    #[test]
    fn points_are_all_combinations() {
        let grid = grid(3);
        let [clearance, deformation, rate, latched] = grid.axes();
        assert_eq!(grid.at(0), (0, [clearance[0], deformation[0], rate[0], latched[0]]));
        assert_eq!(grid.at(ROWS - 1), (14, [clearance[14], deformation[99], rate[99], latched[99]]));
        assert_eq!(grid.at(7_654_321), (7, [clearance[7], deformation[65], rate[43], latched[21]]));
    }
}
