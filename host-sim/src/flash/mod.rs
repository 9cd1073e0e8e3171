//! Flashing of an image: the plan of what is written where and, with the feature `probe`, the
//! writing through probe-rs.
//!
//! [`Plan::for_board`] finds every defect of an image before a probe is used: another core, another
//! memory map, data outside the firmware's part of the flash, an invalid vector table.

#[cfg(feature = "log")]
pub mod log;
mod plan;
#[cfg(feature = "probe")]
pub mod probe;

use crate::cli::error::CliError;
pub use plan::{Plan, Segment};

use std::path::{Path, PathBuf};

/// Why nothing was written.
#[derive(Debug, thiserror::Error)]
pub enum FlashError {
    /// The image is missing.
    #[error(
        "{path}: no firmware there; build it with `cargo xtask firmware --board BOARD`, or name one with \
         --elf",
        path = path.display()
    )]
    Missing {
        /// Expected path.
        path: PathBuf,
    },
    /// The image cannot be read.
    #[error("{path}: {source}", path = path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Cause.
        source: std::io::Error,
    },
    /// The image does not fit the board.
    #[error("{path}: found {found}; expected {expected}", path = path.display())]
    Image {
        /// The file.
        path: PathBuf,
        /// Description of what was found.
        found: String,
        /// Description of what was expected.
        expected: String,
    },
    /// The board cannot be written to.
    #[error("{0}")]
    Board(String),
    /// The probe failed.
    #[error("{what}: {cause}")]
    Probe {
        /// The attempted operation.
        what: &'static str,
        /// Error of the probe's library.
        cause: String,
    },
}

impl FlashError {
    /// Creates the error of an image that is missing or cannot be read.
    fn unreadable(path: &Path, source: std::io::Error) -> Self {
        match source.kind() {
            std::io::ErrorKind::NotFound => Self::Missing { path: path.into() },
            _ => Self::Unreadable { path: path.into(), source },
        }
    }
}

impl From<FlashError> for CliError {
    fn from(error: FlashError) -> Self {
        match error {
            FlashError::Probe { .. } => Self::Work(error.to_string()),
            other => Self::Input(other.to_string()),
        }
    }
}
