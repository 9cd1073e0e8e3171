//! The estimators under comparison. Each knows the described bench and the sensors' readings only.

use crate::cli::error::CliError;
use crate::run::configuration::controller_configuration;
use crate::run::force::SAMPLE_RATE_HZ;
use crate::run::sensing;
use ::worlds::{Reading, Sensors};
use bench::description::TransmissionBench;
use bench::plants::transmission::Transmission;
use controller::Estimator;
use controller::estimator::filter_configuration;
use controller::filter::{Filter, Measurement, SensorNoise};
use inference::shipped;
use link::{ContactSource, ControllerConfiguration};
use schemars::JsonSchema;
use serde::Serialize;

/// An estimator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub enum EstimatorKind {
    /// The controller's estimator with the networks as the source of the contact.
    #[serde(rename = "network")]
    Network,
    /// The controller's estimator with the analytic law.
    #[serde(rename = "law")]
    Law,
    /// The filter with the law and the measured drive force, which no controller measures yet.
    #[serde(rename = "law with drive force")]
    LawWithDriveForce,
}

impl EstimatorKind {
    /// Every estimator.
    pub const ALL: [Self; 3] = [Self::Network, Self::Law, Self::LawWithDriveForce];
}

/// Estimate of one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Force of the bearing on the journal along Y and Z, N.
    pub force_n: [f64; 2],
    /// Torque of the bearing on the shaft, N m.
    pub torque_nm: f64,
    /// Standard deviation of the force in N and of the torque in N m.
    pub deviations: [f64; 2],
}

/// Follows the readings with an estimator for the described bench.
pub fn follow(
    kind: EstimatorKind,
    bench: &TransmissionBench,
    readings: &[Reading],
) -> Result<Vec<Estimate>, CliError> {
    match kind {
        EstimatorKind::Network => ticks(bench, readings, ContactSource::Network),
        EstimatorKind::Law => ticks(bench, readings, ContactSource::Law),
        EstimatorKind::LawWithDriveForce => with_drive_force(bench, readings),
    }
}

fn refused(name: &str, reason: &dyn std::fmt::Debug) -> CliError {
    CliError::Work(format!("{name}: {reason:?}"))
}

fn configured(
    bench: &TransmissionBench,
    contact: ContactSource,
) -> Result<ControllerConfiguration, CliError> {
    let plant = Transmission::new(bench, bench.drive_profile(), bench.load_profile());
    controller_configuration(&plant, bench, SAMPLE_RATE_HZ, contact)
}

fn ticks(
    bench: &TransmissionBench,
    readings: &[Reading],
    contact: ContactSource,
) -> Result<Vec<Estimate>, CliError> {
    let configuration = configured(bench, contact)?;
    let image = shipped(bench.bearing.material);
    let mut estimator = Estimator::new(image, &configuration.bench, &configuration.monitor)
        .map_err(|e| refused("estimator", &e))?;
    let estimate = |(index, r): (usize, &Reading)| {
        let channels = [r.journal_y_m, r.journal_z_m, r.shaft_angle_rad, r.load_force_n];
        let found = estimator.step(&sensing::frame(index as u32, r.time_s, channels));
        Estimate {
            force_n: [found.force_y_n, found.force_z_n].map(f64::from),
            torque_nm: found.friction_torque_nm.into(),
            deviations: [found.force_sd_n, found.friction_torque_sd_nm].map(f64::from),
        }
    };
    Ok(readings.iter().enumerate().map(estimate).collect())
}

fn with_drive_force(bench: &TransmissionBench, readings: &[Reading]) -> Result<Vec<Estimate>, CliError> {
    let ControllerConfiguration { bench: configuration, monitor, .. } =
        configured(bench, ContactSource::Law)?;
    let mut configuration = filter_configuration(bench.bearing.material, &configuration, &monitor);
    let drive_force_n = Sensors::BENCH_B.drive_force_n as f32;
    configuration.noise = SensorNoise { drive_force_n, ..configuration.noise };
    let mut filter = Filter::new(&configuration).map_err(|e| refused("filter", &e))?;
    let estimate = |r: &Reading| {
        let found = filter.step(&Measurement {
            journal_y_m: r.journal_y_m as f32,
            journal_z_m: r.journal_z_m as f32,
            shaft_angle_rad: r.shaft_angle_rad as f32,
            load_force_n: r.load_force_n as f32,
            drive_force_n: Some(r.drive_force_n as f32),
        });
        Estimate {
            force_n: [found.force_y_n, found.force_z_n].map(f64::from),
            torque_nm: found.friction_torque_nm.into(),
            deviations: [found.force_sd_n, found.friction_torque_sd_nm].map(f64::from),
        }
    };
    Ok(readings.iter().map(estimate).collect())
}
