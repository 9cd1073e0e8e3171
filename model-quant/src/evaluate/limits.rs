//! Limits of an image: its errors beyond the training range and with a wrong deformation rate.

use crate::data::bench_runs::{OutsideShare, RunError, bench_runs, measure_outside_share};
use crate::data::features::FloatFeatures;
use crate::data::static_deformation::{CLEARANCE_M, static_deformation_m};
use crate::quantise::image::{AnyModel, AnyPair};
use inference::{ContactState, WINDOW};

/// Deformations of the probe states relative to the end of the training range.
const BEYOND: [f64; 3] = [1.1, 1.25, 1.5];
/// Load in N of the probe state with a wrong rate.
const RATE_LOAD_N: f64 = 5000.0;
/// Error of that rate in m/s.
pub(crate) const RATE_ERROR_M_S: f64 = 1e-4;
/// Seed of the simulated runs; only their sensor noise depends on it, which is not used here.
const SEED: u64 = 1;

/// Measured limits of an image.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    /// Deformation relative to the end of the range, and relative error of the static normal force
    /// there.
    pub beyond: Vec<(f64, f64)>,
    /// Relative change of the normal force at 5 kN by an error [`RATE_ERROR_M_S`] of the rate, with
    /// the approach speed at its floor.
    pub rate_error: f64,
    /// Shares of the contact samples of bench B's 24 runs outside the training range.
    pub outside: OutsideShare,
}

/// Measures an image.
///
/// # Errors
///
/// The bench cannot be run.
pub fn measure(model: AnyModel<'_>) -> Result<Limits, RunError> {
    let header = model.header();
    let floor_m_s = header.latch_floor_m_s();
    let law = header.bearing.normal_law(CLEARANCE_M, f64::from(floor_m_s));
    let mut pair = AnyPair::new(model);
    let mut force_n = |deformation_m: f64, rate_m_s: f64| {
        pair.reset();
        let state = ContactState {
            radial_clearance_m: CLEARANCE_M as f32,
            deformation_m: deformation_m as f32,
            deformation_rate_m_s: rate_m_s as f32,
            approach_speed_m_s: floor_m_s,
            sliding_speed_m_s: 0.0,
        };
        f64::from((0..WINDOW).fold(0, |_, _| pair.push(&state).normal_force_mn)) / 1000.0
    };
    let deepest_m = f64::from(header.deformation_m().high);
    let beyond = BEYOND.map(|factor| {
        let deformation_m = factor * deepest_m;
        (factor, force_n(deformation_m, 0.0) / law.force_n(deformation_m, 0.0, 0.0) - 1.0)
    });
    let loaded_m =
        static_deformation_m(header.bearing, CLEARANCE_M, RATE_LOAD_N, deepest_m).unwrap_or(deepest_m);
    let change_n = force_n(loaded_m, 0.5 * RATE_ERROR_M_S) - force_n(loaded_m, -0.5 * RATE_ERROR_M_S);
    let rate_error = change_n / force_n(loaded_m, 0.0);
    let runs = bench_runs(header.bearing, SEED)?;
    Ok(Limits {
        beyond: beyond.to_vec(),
        rate_error,
        outside: measure_outside_share(&FloatFeatures::from_header(&header), &runs),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use inference::{BearingMaterial, shipped};

    /// The expected change is chi times the rate error divided by the floor: .21 of Babbitt's
    /// force, .04 of plastic's.
    #[test]
    fn a_rate_error_changes_the_force_by_the_damping() {
        for (bearing, expected) in [(BearingMaterial::Babbitt, 0.21), (BearingMaterial::Plastic, 0.04)] {
            let limits = measure(AnyModel::load(shipped(bearing)).unwrap()).unwrap();
            assert!((limits.rate_error / expected - 1.0).abs() < 0.1, "{bearing:?}: {}", limits.rate_error);
            assert!(limits.outside.any < 0.05 && limits.outside.deformation == 0.0);
            assert_eq!(limits.beyond.len(), BEYOND.len());
        }
    }
}
