//! Judges all draws on all cores, except those in the journal.

use super::parameter_box::{BOX, Draw, Parameter};
use super::verdicts::{Letters, evaluate_draw};
use crate::cli::error::CliError;
use crate::cli::parallel;
use crate::journal::Journal;
use crate::reproduction::claims::cycles::slider_crank_ratios;
use crate::shard::{self, Numbered, Shard};
use bench::description::TransmissionBench;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// File name of the journal in the output folder.
pub(crate) const NAME: &str = "journal.jsonl";

/// Identity of a campaign. If any field differs, the draws are different ones. The number of draws
/// is not part of it, so a campaign can be extended.
#[derive(Serialize)]
struct Header {
    version: &'static str,
    seed: u64,
    bench: String,
    parameters: [Parameter; BOX.len()],
}

/// A judged draw.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Record {
    /// Number of the draw.
    pub index: usize,
    /// The verdicts, or the reason why there are none.
    pub outcome: Result<Letters, String>,
}

impl Numbered for Record {
    fn number(&self) -> usize {
        self.index
    }
}

/// Judges the draws of a shard of `0..runs` and returns the records in order. With a folder it
/// keeps a journal there and continues it.
pub fn run(
    base: &TransmissionBench,
    (seed, runs, shard): (u64, usize, Shard),
    threads: usize,
    folder: Option<&Path>,
    progress: impl Fn() + Sync,
) -> Result<Vec<Record>, CliError> {
    let (journal, mut finished) = open(base, seed, folder)?;
    finished.retain(|index, _| *index < runs && shard.contains(*index));
    finished.values().for_each(|_| progress());
    let is_missing = |index: &usize| shard.contains(*index) && !finished.contains_key(index);
    let missing: Vec<usize> = (0..runs).filter(is_missing).collect();
    let ratios = slider_crank_ratios()?;
    let journal = Mutex::new(journal);
    let fresh = parallel::map(threads, &missing, |_, &index| {
        let outcome = evaluate_draw(base, Some(&Draw::new(seed, index)), ratios).map_err(|e| e.to_string());
        let record = Record { index, outcome };
        if let Some(journal) = journal.lock().unwrap_or_else(PoisonError::into_inner).as_mut() {
            journal.append(&record)?;
        }
        progress();
        Ok(record)
    })?;
    finished.extend(fresh.into_iter().map(|record| (record.index, record)));
    Ok(finished.into_values().collect())
}

type Opened = (Option<Journal>, BTreeMap<usize, Record>);

fn open(base: &TransmissionBench, seed: u64, folder: Option<&Path>) -> Result<Opened, CliError> {
    let Some(folder) = folder else { return Ok((None, BTreeMap::new())) };
    let (journal, records) = Journal::open::<Record>(&folder.join(NAME), &header(base, seed)?)?;
    Ok((Some(journal), records.into_iter().map(|record| (record.index, record)).collect()))
}

fn header(base: &TransmissionBench, seed: u64) -> Result<Header, CliError> {
    let bench = bench::Bench::from(base.clone());
    let bench = bench.to_toml().map_err(|e| CliError::Work(e.to_string()))?;
    Ok(Header { version: env!("CARGO_PKG_VERSION"), seed, bench, parameters: BOX })
}

/// Returns the records of the draws `0..runs` from the journals of their shards.
pub(crate) fn merge(
    base: &TransmissionBench,
    (seed, runs): (u64, usize),
    shards: &[PathBuf],
    out: &Path,
) -> Result<Vec<Record>, CliError> {
    Ok(shard::merge(shards, out, NAME, &header(base, seed)?, runs)?)
}
