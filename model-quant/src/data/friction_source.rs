//! Sources of the groups of a friction set: a described rig or measured logs. SI units, one log a
//! group.

use bench::description::FrictionRig;
use bench::simulate::rig_groups;
use bench::{Bench, DescriptionError, MeasuredLog};
use inference::BearingMaterial;
use std::path::PathBuf;

/// Reason why there is no friction set.
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
        /// Content found.
        found: String,
        /// Content expected.
        expected: String,
    },
}

impl FrictionError {
    /// Returns true if a file or a description is wrong, false if the simulation failed.
    pub(crate) fn is_wrong_input(&self) -> bool {
        !matches!(self, Self::Rig(_))
    }
}

/// Records the groups of a rig from a preset or description file through its sensors. If the rig
/// names its material pair, it must be that of the bearing.
pub fn from_rig(
    description: &str,
    bearing: BearingMaterial,
    seed: u64,
) -> Result<Vec<MeasuredLog>, FrictionError> {
    let refused = |found: String, expected: &str| FrictionError::Content {
        file: description.into(),
        found,
        expected: expected.into(),
    };
    let rig = FrictionRig::open(description)?;
    let material = rig.surface.as_ref().map(|surface| surface.material.name());
    if let Some(material) = material.filter(|material| *material != bearing.name()) {
        return Err(refused(format!("a {material} pair"), bearing.name()));
    }
    Ok(rig_groups(&rig, seed)?.into_iter().map(|group| group.log).collect())
}

/// Records the same groups without noise, resolution and outliers: the ideal result of cleaning.
/// Sensor drift remains, because no average removes it.
pub fn truth_of_rig(description: &str, seed: u64) -> Result<Vec<MeasuredLog>, FrictionError> {
    let mut rig = FrictionRig::open(description)?;
    for sensor in rig.common.sensors.values_mut() {
        (sensor.noise, sensor.resolution, sensor.outlier_share) = (0.0, 0.0, 0.0);
    }
    Ok(rig_groups(&rig, seed)?.into_iter().map(|group| group.log).collect())
}

/// Reads measured logs in the format of a bench description, one group a file.
pub(crate) fn from_logs(description: &str, files: &[PathBuf]) -> Result<Vec<MeasuredLog>, FrictionError> {
    let format = Bench::open(description)?.log_format();
    files.iter().map(|file| Ok(MeasuredLog::read(file, &format)?)).collect()
}
