//! The training report: the paper's Figs. 10 to 13 from the networks as they are, their errors against the goals, claims 12 to
//! 15, and what the quantisation costs.
//!
//! [`facts`] measures, [`history`] reads how the errors went over the epochs, [`rig`] holds the rig's networks against its
//! records, [`companding`] reads the comparison of targets, [`torque`] asks the networks for torque over load and speed,
//! [`pictures`] draws and [`page`] puts it together. Everything follows from checkpoint and seed; the same
//! bytes every time.

pub mod companding;
pub mod facts;
pub mod history;
pub mod page;
pub mod pictures;
pub mod rig;
pub mod rig_pictures;
mod tables;
pub mod torque;

use serde::de::DeserializeOwned;
use std::path::Path;

/// Why a file that the report is to show was refused.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// It cannot be read.
    #[error("{path}: {source}")]
    Read {
        /// The file.
        path: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// Its content is not what it should be.
    #[error("{path}: found {found}; expected {expected}")]
    Content {
        /// The file.
        path: String,
        /// What there is, and where.
        found: String,
        /// What there should be.
        expected: String,
    },
}

impl FileError {
    fn content(path: &Path, found: impl ToString, expected: impl ToString) -> Self {
        let (found, expected) = (found.to_string(), expected.to_string());
        Self::Content { path: path.display().to_string(), found, expected }
    }

    /// A file's text.
    fn text(path: &Path) -> Result<String, Self> {
        std::fs::read_to_string(path)
            .map_err(|source| Self::Read { path: path.display().to_string(), source })
    }

    /// A text as JSON.
    fn json<T: DeserializeOwned>(path: &Path, text: &str, expected: &str) -> Result<T, Self> {
        serde_json::from_str(text).map_err(|error| Self::content(path, error, expected))
    }
}

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The image was refused.
    #[error("image: {0}")]
    Image(#[from] inference::ImageError),
    /// A checkpoint could not be quantised.
    #[error("{0}")]
    Quantise(#[from] crate::quantise::QuantiseError),
    /// A checked-in checkpoint was refused.
    #[error("{0}")]
    Checkpoint(#[from] crate::checkpoint::CheckpointError),
    /// The bench could not be run.
    #[error("{0}")]
    Run(#[from] crate::dataset::bench_runs::RunError),
    /// The friction rig could not be recorded.
    #[error("{0}")]
    Friction(#[from] crate::dataset::friction_source::FrictionError),
    /// A file that the report is to show was refused.
    #[error("{0}")]
    File(#[from] FileError),
    /// A picture could not be drawn.
    #[error("{0}")]
    Picture(String),
}
