//! Axes of the paper's Table 2: 15 clearances, 100 deformations, 100 rates, 100 approach speeds.
//!
//! The paper gives a number of samples for every parameter and a total of 1.5e7, which is the
//! product of the four. So the values are drawn axis by axis, and the set contains all
//! combinations. Each axis is stratified: value `j` of `n` is the quantile of its distribution at a
//! uniform draw between `j/n` and `(j+1)/n`. Without strata 15 clearances could leave a third of
//! the range empty by chance. Values of an axis rise strictly, so points of the grid are different
//! rows.
//!
//! Clearances are uniform with a minimum of 1 um, because the law is singular at 0. The other three
//! axes are exponential with a mean of a fifth of the range (the paper does not give it), truncated
//! at its end. Both bearings have the same axes for the same seed. Values are f32 in m and m/s.
//!
//! The networks limit the ratio of rate to approach speed ([`limited_rate_m_s`]), so the rates
//! beyond the limit become one rate. The limited grid contains that rate once for each approach
//! speed: about 13 of the 15 million points remain, and no row occurs twice.

use crate::data::draw::{Draw, Purpose};
use crate::data::features::FloatFeatures;
use crate::data::rows::limited_rate_m_s;
use libm::{exp, log};

/// Number of values of every axis in Table 2.
pub(crate) const COUNTS: [u64; 4] = [15, 100, 100, 100];
/// Points of the complete grid.
pub(crate) const ROWS: u64 = 15_000_000;
/// Upper end of rate and approach speed in m/s.
const RATE_HIGH_M_S: f64 = 1.0;
/// Range of the exponential distributions divided by their mean.
const MEANS: f64 = 5.0;

/// Values of the four axes (clearance, deformation, rate, approach speed), and the points in use.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ParameterGrid {
    axes: [Vec<f32>; 4],
    /// Indices of rate and approach speed of every pair that is not merged into another one.
    pairs: Vec<[u8; 2]>,
}

/// Quantile at `probability` of the exponential distribution truncated at `high`.
fn exponential(high: f64, probability: f64) -> f64 {
    -high / MEANS * log(1.0 - (1.0 - exp(-MEANS)) * probability)
}

impl ParameterGrid {
    /// Draws the axes for a seed over the ranges of `features`, for the grid as printed.
    pub(crate) fn draw(features: &FloatFeatures, seed: u64) -> Self {
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
            let mut last = 0.0_f32;
            let value = |j| {
                let value = quantile(axis, (j as f64 + draw.unit()) / count as f64) as f32;
                last = value.max(last.next_up());
                last
            };
            (0..count).map(value).collect()
        });
        let [_, _, rates, speeds] = COUNTS.map(|count| count as u8);
        let pairs = (0..rates).flat_map(|rate| (0..speeds).map(move |speed| [rate, speed])).collect();
        Self { axes, pairs }
    }

    /// Returns the grid without the pairs whose limited rate is that of a lower one.
    pub(crate) fn limited(mut self, features: &FloatFeatures) -> Self {
        let [.., rates, speeds] = &self.axes;
        let limited = |rate: u8, speed: u8| {
            let value = |axis: &[f32], index: u8| axis.get(usize::from(index)).copied().unwrap_or_default();
            limited_rate_m_s(features, value(rates, rate), value(speeds, speed))
        };
        // Rates rise, so equal limited rates are neighbours.
        self.pairs.retain(|&[rate, speed]| {
            rate.checked_sub(1).is_none_or(|below| limited(below, speed) < limited(rate, speed))
        });
        self
    }

    /// Number of points.
    pub(crate) fn points(&self) -> u64 {
        let [clearances, deformations, ..] = &self.axes;
        (clearances.len() * deformations.len() * self.pairs.len()) as u64
    }

    /// The four axes.
    pub(crate) fn axes(&self) -> &[Vec<f32>; 4] {
        &self.axes
    }

    /// Index of the clearance and the four values at a point of the grid. Points beyond the last
    /// wrap around.
    pub(crate) fn at(&self, point: u64) -> (usize, [f32; 4]) {
        let [clearances, deformations, ..] = &self.axes;
        let pairs = self.pairs.len().max(1) as u64;
        let (row, pair) = (point / pairs, (point % pairs) as usize);
        let deformation = (row % deformations.len().max(1) as u64) as usize;
        let clearance = (row / deformations.len().max(1) as u64) as usize % clearances.len().max(1);
        let [rate, speed] = self.pairs.get(pair).copied().unwrap_or_default().map(usize::from);
        let indices = [clearance, deformation, rate, speed];
        let mut values = [0.0; 4];
        for ((axis, index), value) in self.axes.iter().zip(indices).zip(&mut values) {
            *value = axis.get(index).copied().unwrap_or_default();
        }
        (clearance, values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::ranges::{RangeKind, header};
    use inference::BearingMaterial;

    fn grid(seed: u64) -> ParameterGrid {
        ParameterGrid::draw(
            &FloatFeatures::from_header(&header(BearingMaterial::Babbitt, RangeKind::Paper)),
            seed,
        )
    }

    #[test]
    fn the_axes_have_the_means_and_quantiles_of_their_distributions() {
        let grid = grid(3);
        let [clearance, deformation, rate, approach] = grid.axes();
        assert_eq!(ROWS, COUNTS.iter().product::<u64>());
        let mean = |axis: &[f32]| axis.iter().map(|&v| f64::from(v)).sum::<f64>() / axis.len() as f64;
        assert!((mean(clearance) / 0.75e-3 - 1.0).abs() < 0.03, "{}", mean(clearance));
        // Mean of the truncated exponential divided by its range: 1/5 - 1/(e^5 - 1).
        let expected = 0.2 - 1.0 / (5.0_f64.exp() - 1.0);
        for (axis, high) in [(deformation, 1e-4), (rate, 1.0), (approach, 1.0)] {
            assert!((mean(axis) / (high * expected) - 1.0).abs() < 0.01, "{}", mean(axis));
            assert!(axis.windows(2).all(|w| w[0] < w[1]));
            assert!(axis[0] > 0.0 && f64::from(axis[99]) < high);
            // Stratified: the value between the 50th and the 51st stratum is the median.
            let median = -high / 5.0 * (1.0 - 0.5 * (1.0 - (-5.0_f64).exp())).ln();
            assert!(f64::from(axis[49]) <= median && median <= f64::from(axis[50]));
        }
        assert_ne!(rate, approach);
        assert_ne!(grid, super::tests::grid(4));
    }

    #[test]
    fn the_limited_grid_has_every_limited_row_once() {
        let features = FloatFeatures::from_header(&header(BearingMaterial::Babbitt, RangeKind::Paper));
        let (printed, limited) = (grid(3), grid(3).limited(&features));
        assert_eq!(printed.points(), ROWS);
        let [.., rates, speeds] = printed.axes();
        let distinct = |grid: &ParameterGrid| {
            let pairs = grid.pairs.iter().map(|p| p.map(usize::from));
            let rows = pairs.map(|[r, s]| [limited_rate_m_s(&features, rates[r], speeds[s]), speeds[s]]);
            rows.map(|row| row.map(f32::to_bits)).collect::<std::collections::BTreeSet<_>>()
        };
        assert_eq!(limited.points(), 1500 * limited.pairs.len() as u64);
        assert_eq!(distinct(&limited).len(), limited.pairs.len());
        assert_eq!(distinct(&limited), distinct(&printed));
        // 14.1 % of the points lie beyond the limit, and one rate in a hundred remains of them.
        assert!((0.855..0.88).contains(&(limited.points() as f64 / ROWS as f64)), "{}", limited.points());
    }

    #[test]
    fn points_are_all_combinations() {
        let grid = grid(3);
        let [clearance, deformation, rate, approach] = grid.axes();
        assert_eq!(grid.at(0), (0, [clearance[0], deformation[0], rate[0], approach[0]]));
        assert_eq!(grid.at(ROWS - 1), (14, [clearance[14], deformation[99], rate[99], approach[99]]));
        assert_eq!(grid.at(7_654_321), (7, [clearance[7], deformation[65], rate[43], approach[21]]));
    }
}
