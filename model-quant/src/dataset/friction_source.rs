//! Where the groups of a friction set come from: a described rig or measured logs. SI, a group a log.

use bench::rig_groups::rig_groups;
use bench::{Bench, DescriptionError, MeasuredLog};
use inference::Bearing;
use std::path::PathBuf;

/// Why there is no friction set.
#[derive(Debug, thiserror::Error)]
pub enum FrictionError {
    /// The bench's description was refused.
    #[error("{0}")]
    Description(#[from] DescriptionError),
    /// The rig could not be recorded.
    #[error("friction rig: {0}")]
    Rig(#[from] bench::integrate::IntegrationError),
    /// A log could not be read.
    #[error("{0}")]
    Log(#[from] bench::log::LogError),
    /// A log or a description does not have what the set needs.
    #[error("{file}: found {found}, expected {expected}")]
    Content {
        /// The file, or the preset.
        file: String,
        /// What there is.
        found: String,
        /// What there should be.
        expected: String,
    },
}

impl FrictionError {
    /// Whether files or descriptions are at fault.
    pub fn is_wrong_input(&self) -> bool {
        !matches!(self, Self::Rig(_))
    }
}

/// The groups of a rig described in a preset or file, as its sensors log them. A rig that names its rubbing pair must have that of
/// the bearing.
pub fn from_rig(description: &str, bearing: Bearing, seed: u64) -> Result<Vec<MeasuredLog>, FrictionError> {
    let refused = |found: String, expected: &str| FrictionError::Content {
        file: description.into(),
        found,
        expected: expected.into(),
    };
    let Bench::FrictionRig(rig) = Bench::open(description)? else {
        return Err(refused("another plant".into(), "a friction rig, or --logs"));
    };
    let material = rig.surface.as_ref().map(|surface| surface.material.name());
    if let Some(material) = material.filter(|material| *material != bearing.name()) {
        return Err(refused(format!("a {material} pair"), bearing.name()));
    }
    Ok(rig_groups(&rig, seed)?.into_iter().map(|group| group.log).collect())
}

/// The same groups without noise, resolution and outliers: what cleaning should come near. A sensor's drift stays: no
/// average takes it out.
pub fn truth_of_rig(description: &str, seed: u64) -> Result<Vec<MeasuredLog>, FrictionError> {
    let Bench::FrictionRig(mut rig) = Bench::open(description)? else { return Ok(Vec::new()) };
    for sensor in rig.sensors.values_mut() {
        (sensor.noise, sensor.resolution, sensor.outlier_share) = (0.0, 0.0, 0.0);
    }
    Ok(rig_groups(&rig, seed)?.into_iter().map(|group| group.log).collect())
}

/// Measured logs, one group a file, read as a bench description says.
pub fn from_logs(description: &str, files: &[PathBuf]) -> Result<Vec<MeasuredLog>, FrictionError> {
    let format = Bench::open(description)?.log_format();
    files.iter().map(|file| Ok(MeasuredLog::read(file, &format)?)).collect()
}
