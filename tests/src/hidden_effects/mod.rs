//! Test of the diagnosis with hidden effects: logs, answers, figures and goals.
//!
//! A [`cell`] defines the hidden effects. [`run`] lets the generator write a log, gives the engine
//! this log alone, and scores the answer with [`compare`]. [`pairs`] and [`changed`] are the cells
//! that ask several questions. [`score`] sums up, [`goals`] compares with goals and golden figures,
//! and [`page`] writes the published pages. [`mystery`] writes a log for a person to diagnose.

pub mod cell;
mod cell_run;
pub mod changed;
pub mod compare;
pub mod goals;
pub mod mystery;
pub mod page;
pub mod pairs;
pub mod run;
pub mod score;

/// Reason why a campaign failed.
#[derive(Debug, thiserror::Error)]
pub enum CampaignError {
    /// A file cannot be used.
    #[error("{file}: {found}; expected {expected}")]
    File {
        /// Path.
        file: String,
        /// Content or error that was found.
        found: String,
        /// Expected content.
        expected: &'static str,
    },
    /// The journal cannot be used.
    #[error(transparent)]
    Journal(#[from] crate::journal::JournalError),
    /// Shards cannot be merged.
    #[error(transparent)]
    Merge(#[from] host_sim::shard::MergeError),
    /// The engine rejected a log.
    #[error("cell {cell}: {found}")]
    Engine {
        /// Number of the cell.
        cell: usize,
        /// Message of the engine.
        found: String,
    },
    /// A label is requested before there is a diagnosis.
    #[error("{name}: found no diagnosis.json; expected a diagnosis of the log before its label is shown")]
    NoDiagnosis {
        /// Folder of the log.
        name: String,
    },
}
