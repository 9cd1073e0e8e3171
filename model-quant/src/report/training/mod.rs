//! Training report: the paper's Figs. 10 to 13 for the current networks, errors against the goals,
//! claims 12 to 15, and quantisation errors.
//!
//! [`facts`] measures the networks, [`rig`] compares the rig's networks with its records,
//! [`companding`] reads the comparison of targets, [`pictures`] draws and [`page`] writes the page.
//! The report depends on checkpoint and seed alone and has the same bytes every time.

pub(crate) mod companding;
pub(crate) mod facts;
pub(crate) mod page;
pub(crate) mod pictures;
pub(crate) mod rig;
pub(crate) mod rig_pictures;
mod tables;

use crate::data::file_io::FileError;

/// Reason why there is no report.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ReportError {
    /// The image was refused.
    #[error("image: {0}")]
    Image(#[from] inference::ImageError),
    /// A checkpoint could not be quantised.
    #[error("{0}")]
    Quantise(#[from] crate::quantise::QuantiseError),
    /// A shipped checkpoint was refused.
    #[error("{0}")]
    Checkpoint(#[from] crate::network::checkpoint::CheckpointError),
    /// The bench could not be simulated.
    #[error("{0}")]
    Run(#[from] crate::data::bench_runs::RunError),
    /// The friction rig could not be simulated.
    #[error("{0}")]
    Friction(#[from] crate::data::friction_source::FrictionError),
    /// An input file of the report was refused.
    #[error("{0}")]
    File(#[from] FileError),
    /// A picture could not be drawn.
    #[error("{0}")]
    Picture(String),
}
