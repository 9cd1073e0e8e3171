//! The diagnosis put to the test: logs with hidden effects, answers, figures beside the goals.
//!
//! A [`cell`] says what is hidden where; [`run`] has the generator write a log, seals the label ([`seal`]), has the engine
//! answer from the log alone and only then opens the label; [`compare`] judges the answer, [`pairs`] and [`changed`] are the cells
//! that ask more than one question; [`score`] sums up over cells, [`goals`] are beside it, [`crate::journal`] keeps them over a kill, [`page`] writes what is published. [`mystery`] deals a log
//! to people.

pub mod cell;
pub mod changed;
pub mod compare;
pub mod goals;
pub mod mystery;
pub mod page;
pub mod pairs;
pub mod run;
pub mod score;
pub mod seal;

/// Why a campaign failed.
#[derive(Debug, thiserror::Error)]
pub enum CampaignError {
    /// A file.
    #[error("{file}: {found}; expected {expected}")]
    File {
        /// The file.
        file: String,
        /// What was found.
        found: String,
        /// What was expected.
        expected: &'static str,
    },
    /// The journal of the campaign.
    #[error(transparent)]
    Journal(#[from] crate::journal::JournalError),
    /// The engine refused.
    #[error("cell {cell}: {found}")]
    Engine {
        /// Number of the cell.
        cell: usize,
        /// Its message.
        found: String,
    },
    /// A label was to be opened before its answer was written.
    #[error(
        "the label of {name} is sealed: found no answer of that name; expected the engine's answer first"
    )]
    Sealed {
        /// Name of the log.
        name: String,
    },
}
