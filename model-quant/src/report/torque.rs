//! Friction torque over speed and load from the networks of an image: the paper's Figs. 12 and 13.
//!
//! The networks run as on the controller: a static contact whose force under the law is the load,
//! at a constant sliding speed, until the window is full. So the torque has the errors of both
//! networks. Loads and speeds are those of the bench; those of the rig lie beyond the training
//! range.

use crate::data::static_deformation::{CLEARANCE_M, static_deformation_m};
use crate::evaluate::errors::FRICTION_RADIUS_M;
use crate::quantise::image::{AnyModel, AnyPair};
use inference::{ContactState, Header, WINDOW};
use serde::Serialize;

/// Loads in N of the curves.
pub(crate) const LOADS_N: [f64; 5] = [1e3, 2e3, 5e3, 10e3, 14e3];
/// Sliding speeds in m/s of the map.
pub(crate) const SPEEDS_M_S: [f64; 8] = [0.001, 0.003, 0.01, 0.02, 0.05, 0.1, 0.15, 0.25];
/// Number of points of a curve.
const POINTS: usize = 80;
/// Lowest sliding speed of a curve in m/s.
const SLOWEST_M_S: f64 = 5e-4;

/// Torque in N m at one load over sliding speed in m/s, ascending.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Curve {
    /// Load in N.
    pub load_n: f64,
    /// Speed, torque of the networks, torque of the law.
    pub points: Vec<(f64, f64, f64)>,
}

/// Curves of an image at the loads of [`LOADS_N`] inside its training range.
pub(crate) fn curves(model: AnyModel<'_>, speeds_m_s: &[f64]) -> Vec<Curve> {
    let header = model.header();
    let law = header.bearing.friction_law();
    let mut pair = AnyPair::new(model);
    let curve = |load_n: f64| {
        let deepest_m = f64::from(header.deformation_m().high);
        let deformation_m = static_deformation_m(header.bearing, CLEARANCE_M, load_n, deepest_m)?;
        let points = speeds_m_s.iter().map(|&speed| {
            pair.reset();
            let state = ContactState {
                radial_clearance_m: CLEARANCE_M as f32,
                deformation_m: deformation_m as f32,
                deformation_rate_m_s: 0.0,
                approach_speed_m_s: header.latch_floor_m_s(),
                sliding_speed_m_s: speed as f32,
            };
            let found = (0..WINDOW).fold(0, |_, _| pair.push(&state).friction_force_mn);
            let torque = |force_n: f64| force_n.abs() * FRICTION_RADIUS_M;
            (speed, torque(f64::from(found) / 1000.0), torque(law.force_n(load_n, speed)))
        });
        Some(Curve { load_n, points: points.collect() })
    };
    LOADS_N.into_iter().filter_map(curve).collect()
}

/// Logarithmically spaced speeds up to the end of the training range.
pub(crate) fn speeds(header: &Header) -> Vec<f64> {
    let highest = f64::from(header.sliding_speed_m_s().high);
    let share = |i: usize| i as f64 / (POINTS - 1) as f64;
    (0..POINTS).map(|i| SLOWEST_M_S * (highest / SLOWEST_M_S).powf(share(i))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use inference::{BearingMaterial, shipped};

    #[test]
    fn the_networks_torque_follows_the_law_over_speed_and_load() {
        for bearing in BearingMaterial::ALL {
            let model = AnyModel::load(shipped(bearing)).unwrap();
            let curves = curves(model, &SPEEDS_M_S);
            assert!(curves.len() >= 4, "{bearing:?}");
            for curve in curves {
                for (speed, network, law) in curve.points {
                    let error = network / law - 1.0;
                    assert!(error.abs() < 0.05, "{bearing:?}, {} N, {speed} m/s: {error}", curve.load_n);
                }
            }
        }
    }

    #[test]
    fn speeds_ascend_to_the_end_of_the_range() {
        let speeds = speeds(&AnyModel::load(shipped(BearingMaterial::Plastic)).unwrap().header());
        assert!(speeds.windows(2).all(|w| w[0] < w[1]) && (speeds[POINTS - 1] - 0.25).abs() < 1e-6);
    }
}
