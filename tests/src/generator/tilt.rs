//! Tilt of the shaft of [`super::planar_plant`]: contact along the bearing, and supports of the
//! shaft.
//!
//! The contact is integrated along the bearing by Gauss-Legendre quadrature with five nodes; the
//! engine has equal slices.

use super::hidden::{HiddenEffect, total};

/// Number of nodes along the bearing.
pub(super) const NODES: usize = 5;
/// Length of the bearing, m.
pub(super) const LENGTH_M: f64 = 0.140;
/// Nodes on -1 to 1 with their weights.
const RULE: [(f64, f64); NODES] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.906_179_845_938_664, 0.236_926_885_056_189_08),
];

/// A shaft that may tilt.
pub(super) struct Tilt {
    /// Nodes along the bearing in m from its middle, with their share of its length.
    pub(super) nodes: Vec<(f64, f64)>,
    /// Slopes of the bearing's axis in Y and Z.
    pub(super) bearing: (f64, f64),
    /// Planes of the drive and the load crank, m.
    pub(super) drive_plane_m: f64,
    pub(super) load_plane_m: f64,
    /// Moment of inertia across the shaft, kg m2.
    pub(super) inertia: f64,
    stiffness: f64,
    damping: f64,
}

impl Tilt {
    /// Returns a shaft that does not tilt.
    pub(super) fn none() -> Self {
        Self {
            nodes: vec![(0.0, 1.0)],
            bearing: (0.0, 0.0),
            drive_plane_m: 0.0,
            load_plane_m: 0.0,
            inertia: 1.0,
            stiffness: 0.0,
            damping: 0.0,
        }
    }

    /// Returns the shaft of `two-plane.toml`.
    pub(super) fn described(effects: &[HiddenEffect]) -> Self {
        let slope = |parameter: &str| total(effects, "misalignment", parameter);
        Self {
            nodes: RULE.iter().map(|(x, weight)| (0.5 * LENGTH_M * x, 0.5 * weight)).collect(),
            bearing: (slope("slope_y_rad"), slope("slope_z_rad")),
            drive_plane_m: 0.02,
            load_plane_m: -0.02,
            inertia: 10.0,
            stiffness: 3e6,
            damping: 500.0,
        }
    }

    /// Returns the moment of the supports against a slope and its rate, N m.
    pub(super) fn upright(&self, slope: f64, rate: f64) -> f64 {
        -self.stiffness * slope - self.damping * rate
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nodes_sum_a_power_of_nine_exactly() {
        let tilt = Tilt::described(&[]);
        for power in 0..10 {
            let sum: f64 = tilt.nodes.iter().map(|(x, share)| share * (2.0 * x / LENGTH_M).powi(power)).sum();
            let mean = if power % 2 == 0 { 1.0 / f64::from(power + 1) } else { 0.0 };
            assert!((sum - mean).abs() < 1e-14, "{power}: {sum} {mean}");
        }
    }
}
