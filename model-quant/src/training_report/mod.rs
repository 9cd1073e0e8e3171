//! The training report: the paper's Figs. 10 to 13 from the networks as they are, their errors against the goals, claims 12 to
//! 15, and what the quantisation costs.
//!
//! [`facts`] measures, [`history`] reads how the errors went over the epochs, [`torque`] asks the networks for torque over load
//! and speed, [`pictures`] draws and [`page`] puts it together. Everything follows from checkpoint and seed; the same
//! bytes every time.

pub mod facts;
pub mod history;
pub mod page;
pub mod pictures;
pub mod torque;

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
    /// A picture could not be drawn.
    #[error("{0}")]
    Picture(String),
}
