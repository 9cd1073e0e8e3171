//! Content of a sweep's journal: what identifies the sweep, and the record of a run.

use super::specification::Specification;
use crate::cli::error::CliError;
use crate::journal::{Journal, JournalError};
use crate::run::summary::Figures;
use crate::shard::Numbered;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// File name in the output folder.
pub(crate) const NAME: &str = "journal.jsonl";

/// Identity of a sweep. If any field differs, the runs are different ones.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Header {
    /// Version of the program.
    pub(crate) version: String,
    /// The sweep.
    pub(crate) specification: Specification,
    /// Description of the base bench.
    pub(crate) bench: String,
    /// Checksums of the networks by bearing; empty for the analytic law.
    pub(crate) networks: BTreeMap<String, String>,
    /// Communication step of the networks, s.
    pub(crate) step_s: f64,
}

/// A finished run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Record {
    /// Number of the point, from 0.
    pub(crate) index: usize,
    /// The figures, or the reason why there are none.
    pub(crate) outcome: Result<Figures, String>,
    /// Wall time, s.
    pub(crate) wall_s: f64,
}

impl Numbered for Record {
    fn number(&self) -> usize {
        self.index
    }
}

/// Opens the journal of a sweep in a folder and returns the finished runs by number.
pub(crate) fn open(
    folder: &Path,
    header: &Header,
    runs: usize,
) -> Result<(Journal, BTreeMap<usize, Record>), CliError> {
    let (journal, records) = Journal::open::<Record>(&folder.join(NAME), header)?;
    if let Some(record) = records.iter().find(|record| record.index >= runs) {
        return Err(CliError::Input(format!(
            "{}: found run {}; expected 0 to {}; remove the journal or choose another folder",
            folder.join(NAME).display(),
            record.index,
            runs.saturating_sub(1)
        )));
    }
    Ok((journal, records.into_iter().map(|record| (record.index, record)).collect()))
}

impl From<JournalError> for CliError {
    fn from(error: JournalError) -> Self {
        match error {
            JournalError::Other { .. } => Self::Input(error.to_string()),
            JournalError::Locked { .. } | JournalError::Unusable { .. } => Self::Work(error.to_string()),
        }
    }
}
