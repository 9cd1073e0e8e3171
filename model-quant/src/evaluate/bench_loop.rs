//! Accuracy of an image in the bench's closed loop and with noisy sensors, as measured by `host-sim
//! accuracy`.
//!
//! The command writes `bench-loop.json`. The file for the shipped images is stored next to their
//! checkpoints, and `model-quant quantize` copies it to the model cards. A measurement applies only
//! to the image with its checksum.

use crate::data::file_io::FileError;
use crate::data::statistics::{median, quantile};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Median and largest magnitude over several runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Median.
    pub median: f64,
    /// Largest.
    pub largest: f64,
}

impl Spread {
    /// Computes the statistics of the magnitudes of some values; 0 without values.
    pub fn from_values(values: impl Iterator<Item = f64>) -> Self {
        let mut sizes: Vec<f64> = values.map(f64::abs).collect();
        Self { median: median(&mut sizes), largest: quantile(&mut sizes, 1.0) }
    }
}

/// Statistics over a set of runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoopSet {
    /// Number of runs.
    pub runs: usize,
    /// Relative change of the peak contact force if the networks replace the law.
    pub peak_change: Spread,
    /// Relative change of the oscillation's rms.
    pub oscillation_change: Spread,
    /// Relative change of the oscillation's rms by the law with a zero-order hold over the
    /// networks' step.
    pub held_oscillation_change: Spread,
    /// Rms error of the estimator's force divided by the run's full scale.
    pub force_error: Spread,
    /// The same error of the analytic law on the estimator's signals.
    pub law_force_error: Spread,
    /// Rms error of the estimator's friction torque in N m.
    pub torque_error_nm: Spread,
    /// Number of runs in which the law has a smaller error than the networks on the same signals.
    pub law_wins: usize,
}

/// Measurements of one image.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BenchLoop {
    /// Bearing.
    pub bearing: String,
    /// Checksum of the image in hexadecimal.
    pub image_crc: String,
    /// Communication step of the networks in the loop in us.
    pub step_us: f64,
    /// Seed of the sensor noise.
    pub seed: u64,
    /// Figures on the paper's clearances and loads.
    pub paper: LoopSet,
    /// Figures on held-out conditions.
    pub held_out: LoopSet,
}

/// Reads the measurements of a file.
///
/// # Errors
///
/// The file cannot be read or has other content.
pub(crate) fn read(path: &Path) -> Result<Vec<BenchLoop>, FileError> {
    parse(path, &FileError::text(path)?)
}

fn parse(path: &Path, text: &str) -> Result<Vec<BenchLoop>, FileError> {
    FileError::json(path, text, "the bench-loop.json of `host-sim accuracy`")
}

/// Measurements of the shipped images.
///
/// # Errors
///
/// The embedded file has other content.
pub fn shipped() -> Result<Vec<BenchLoop>, FileError> {
    parse(Path::new("model-quant/models/bench-loop.json"), include_str!("../../models/bench-loop.json"))
}

/// Finds the measurement of an image by its checksum.
pub fn for_image(all: &[BenchLoop], image_crc: u32) -> Option<&BenchLoop> {
    let name = format!("{image_crc:08x}");
    all.iter().find(|found| found.image_crc == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_measurement_applies_to_its_image_only() {
        let all = shipped().unwrap();
        for found in &all {
            let crc = u32::from_str_radix(&found.image_crc, 16).unwrap();
            assert_eq!(for_image(&all, crc), Some(found));
            assert_eq!(for_image(&all, crc ^ 1), None);
        }
        assert!(parse(Path::new("x.json"), "{}").unwrap_err().to_string().starts_with("x.json: found"));
    }

    #[test]
    fn a_spread_is_of_magnitudes() {
        assert_eq!(Spread::from_values([0.1, -0.5, 0.2].into_iter()), Spread { median: 0.2, largest: 0.5 });
        assert_eq!(Spread::from_values(core::iter::empty()), Spread::default());
    }
}
