//! The estimators under comparison. Each knows the described bench and the sensors' readings only.

use crate::cli::error::CliError;
use crate::run::configuration::controller_configuration;
use crate::run::filtered;
use crate::run::force::SAMPLE_RATE_HZ;
use crate::run::sensing;
use ::worlds::{Deviations, Reading, Sensors};
use bench::description::TransmissionBench;
use bench::plants::transmission::Transmission;
use controller::Estimator;
use controller::estimator::Conditioning;
use controller::filter::{Filter, FilterConfiguration, Measurement, SensorNoise, Uncertainty};
use inference::shipped;
use serde::Serialize;

/// An estimator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum EstimatorKind {
    /// The filter on journal position, shaft angle and load.
    #[serde(rename = "filter")]
    Filter,
    /// The same with the measured drive force.
    #[serde(rename = "filter with drive force")]
    FilterWithDriveForce,
    /// The estimator of the controller's tick.
    #[serde(rename = "tick")]
    Tick,
}

impl EstimatorKind {
    /// Every estimator.
    pub const ALL: [Self; 3] = [Self::Filter, Self::FilterWithDriveForce, Self::Tick];
}

/// Estimate of one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Force of the bearing on the journal along Y and Z, N.
    pub force_n: [f64; 2],
    /// Torque of the bearing on the shaft, N m.
    pub torque_nm: f64,
    /// Standard deviation of the force in N and of the torque in N m, if the estimator has one.
    pub deviations: Option<[f64; 2]>,
}

/// Follows the readings with an estimator for the described bench.
pub fn follow(
    kind: EstimatorKind,
    bench: &TransmissionBench,
    readings: &[Reading],
) -> Result<Vec<Estimate>, CliError> {
    match kind {
        EstimatorKind::Filter => filtered(bench, readings, false),
        EstimatorKind::FilterWithDriveForce => filtered(bench, readings, true),
        EstimatorKind::Tick => ticks(bench, readings),
    }
}

fn refused(name: &str, reason: &dyn std::fmt::Debug) -> CliError {
    CliError::Work(format!("{name}: {reason:?}"))
}

fn ticks(bench: &TransmissionBench, readings: &[Reading]) -> Result<Vec<Estimate>, CliError> {
    let plant = Transmission::new(bench, bench.drive_profile(), bench.load_profile());
    let configuration = controller_configuration(&plant, bench, SAMPLE_RATE_HZ)?;
    let bearing = bench.bearing.material;
    let conditioning = Conditioning::from_monitor(&configuration.monitor);
    let mut estimator = Estimator::conditioned(shipped(bearing), configuration.bench, &conditioning)
        .map_err(|e| refused("estimator", &e))?;
    let estimate = |(index, r): (usize, &Reading)| {
        let channels = [r.journal_y_m, r.journal_z_m, r.shaft_angle_rad, r.load_force_n];
        let found = estimator.step(&sensing::frame(index as u32, r.time_s, channels));
        Estimate {
            force_n: [found.force_y_n, found.force_z_n].map(f64::from),
            torque_nm: found.friction_torque_nm.into(),
            deviations: None,
        }
    };
    Ok(readings.iter().enumerate().map(estimate).collect())
}

fn filtered(
    bench: &TransmissionBench,
    readings: &[Reading],
    has_drive_force: bool,
) -> Result<Vec<Estimate>, CliError> {
    let configuration = filter_configuration(bench)?;
    let mut filter = Filter::new(&configuration).map_err(|e| refused("filter", &e))?;
    let estimate = |r: &Reading| {
        let found = filter.step(&Measurement {
            journal_y_m: r.journal_y_m as f32,
            journal_z_m: r.journal_z_m as f32,
            shaft_angle_rad: r.shaft_angle_rad as f32,
            load_force_n: r.load_force_n as f32,
            drive_force_n: has_drive_force.then_some(r.drive_force_n as f32),
        });
        Estimate {
            force_n: [found.force_y_n, found.force_z_n].map(f64::from),
            torque_nm: found.friction_torque_nm.into(),
            deviations: Some([found.force_sd_n, found.friction_torque_sd_nm].map(f64::from)),
        }
    };
    Ok(readings.iter().map(estimate).collect())
}

/// Returns the filter's configuration: the described bench, with noise and deviations of bench B's
/// sensors as the worlds have them.
fn filter_configuration(bench: &TransmissionBench) -> Result<FilterConfiguration, CliError> {
    let (sensors, declared) = (Sensors::BENCH_B, Deviations::BENCH_B);
    let noise = SensorNoise {
        position_m: sensors.position_m as f32,
        angle_rad: sensors.angle_rad as f32,
        drive_force_n: sensors.drive_force_n as f32,
    };
    let uncertainty = Uncertainty {
        mass_share: declared.mass_share as f32,
        inertia_share: declared.inertia_share as f32,
        clearance_m: declared.clearance_m as f32,
        stiffness_share: declared.modulus_share as f32,
        friction_share: declared.friction_share as f32,
        lever_share: declared.lever_share as f32,
    };
    filtered::configuration(bench, noise, uncertainty)
}
