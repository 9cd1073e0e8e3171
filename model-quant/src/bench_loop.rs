//! What an image is worth in the bench's loop and behind noisy sensors, as `host-sim accuracy` measured it.
//!
//! The command writes `bench-loop.json`; the one for the checked-in images is kept beside their checkpoints, and
//! `model-quant quantize` puts it on the model cards. A measurement counts for the image with its check sum only.

use serde::{Deserialize, Serialize};
use std::path::Path;

/// Median and largest magnitude over some runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Median.
    pub median: f64,
    /// Largest.
    pub largest: f64,
}

impl Spread {
    /// The spread of the magnitudes of some values.
    pub fn of(values: impl Iterator<Item = f64>) -> Self {
        let mut sizes: Vec<f64> = values.map(f64::abs).collect();
        sizes.sort_by(f64::total_cmp);
        let at = |place: Option<&f64>| place.copied().unwrap_or(0.0);
        Self { median: at(sizes.get(sizes.len() / 2)), largest: at(sizes.last()) }
    }
}

/// A set of runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoopSet {
    /// Runs.
    pub runs: usize,
    /// Change of the peak contact force by the networks in place of the law, relative.
    pub peak_change: Spread,
    /// Change of the oscillation's rms, relative.
    pub oscillation_change: Spread,
    /// The same by the law held over the networks' step.
    pub held_oscillation_change: Spread,
    /// Rms error of the estimator's force over the run's full scale.
    pub force_error: Spread,
    /// The same of the analytic law on the estimator's signals.
    pub law_force_error: Spread,
    /// Rms error of the estimator's friction torque in N m.
    pub torque_error_nm: Spread,
    /// Runs on which the law errs less than the networks on the same signals.
    pub law_wins: usize,
}

/// What was measured with an image.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BenchLoop {
    /// Bearing.
    pub bearing: String,
    /// Check sum of the image in hexadecimal.
    pub image_crc: String,
    /// Communication step of the networks in the loop.
    pub step_us: f64,
    /// Seed of the sensors' noise.
    pub seed: u64,
    /// On the paper's clearances and loads.
    pub paper: LoopSet,
    /// On held-out conditions.
    pub held_out: LoopSet,
}

/// Why there is no measurement.
#[derive(Debug, thiserror::Error)]
pub enum BenchLoopError {
    /// The file cannot be read.
    #[error("{path}: {source}")]
    Read {
        /// The file.
        path: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// It is none.
    #[error("{path}: found {source}; expected the bench-loop.json of `host-sim accuracy`")]
    Content {
        /// The file.
        path: String,
        /// What is wrong with it.
        source: serde_json::Error,
    },
}

fn parse(path: &str, text: &str) -> Result<Vec<BenchLoop>, BenchLoopError> {
    serde_json::from_str(text).map_err(|source| BenchLoopError::Content { path: path.to_owned(), source })
}

/// Reads the measurements of a file.
///
/// # Errors
///
/// The file cannot be read or has other content.
pub fn read(path: &Path) -> Result<Vec<BenchLoop>, BenchLoopError> {
    let name = path.display().to_string();
    let text = std::fs::read_to_string(path)
        .map_err(|source| BenchLoopError::Read { path: name.clone(), source })?;
    parse(&name, &text)
}

/// The checked-in measurements.
///
/// # Errors
///
/// The checked-in file has other content.
pub fn shipped() -> Result<Vec<BenchLoop>, BenchLoopError> {
    parse("model-quant/models/bench-loop.json", include_str!("../models/bench-loop.json"))
}

/// The measurement of an image, by its check sum.
pub fn of_image(all: &[BenchLoop], image_crc: u32) -> Option<&BenchLoop> {
    let name = format!("{image_crc:08x}");
    all.iter().find(|found| found.image_crc == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_measurement_counts_for_its_image_only() {
        let all = shipped().unwrap();
        for found in &all {
            let crc = u32::from_str_radix(&found.image_crc, 16).unwrap();
            assert_eq!(of_image(&all, crc), Some(found));
            assert_eq!(of_image(&all, crc ^ 1), None);
        }
        assert!(parse("x.json", "{}").unwrap_err().to_string().starts_with("x.json: found"));
    }

    #[test]
    fn a_spread_is_of_magnitudes() {
        assert_eq!(Spread::of([0.1, -0.5, 0.2].into_iter()), Spread { median: 0.2, largest: 0.5 });
        assert_eq!(Spread::of(core::iter::empty()), Spread::default());
    }
}
