//! Writing an image to a board: what would be written where, and with the feature `probe` the writing itself through probe-rs.
//!
//! Everything that can be wrong with an image is found in [`Plan::of`], before a probe is touched: another core, another memory map, data outside the
//! firmware's part of the flash, a vector table that no core would start from.

#[cfg(feature = "log")]
pub mod log;
mod plan;
#[cfg(feature = "probe")]
pub mod probe;

pub use plan::{BOARDS, Board, Plan, Segment, board};

use std::path::PathBuf;

/// Why nothing was written.
#[derive(Debug, thiserror::Error)]
pub enum FlashError {
    /// The image cannot be read.
    #[error("{path}: {source}", path = path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Cause.
        source: std::io::Error,
    },
    /// The image is not one for this board.
    #[error("{path}: found {found}; expected {expected}", path = path.display())]
    Image {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        found: String,
        /// What it should be.
        expected: String,
    },
    /// The board cannot be written to.
    #[error("{0}")]
    Board(String),
    /// The probe did not do what it should.
    #[error("{what}: {cause}")]
    Probe {
        /// What was tried.
        what: &'static str,
        /// What the probe's library said.
        cause: String,
    },
}
