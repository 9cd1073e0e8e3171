//! Shards of a campaign: the part of one machine, and the union of all parts.
//!
//! The runs of a campaign are numbered from 0, and each depends on its number alone. Shard I of N
//! executes the runs whose number is I - 1 modulo N and keeps its own journal. Every journal
//! has the same header: version, seed and description of the campaign. [`merge`] accepts journals
//! with the expected header that contain every run exactly once, so the result has the bytes of a
//! campaign on one machine.

use crate::cli::error::CliError;
use crate::cli::output;
use crate::journal::{Journal, JournalError};
use schemars::JsonSchema;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Maximum number of shards.
const MAX_SHARDS: usize = 100_000;
/// Maximum number of missing runs that a message names.
const NAMED: usize = 10;

/// One of several parts of a campaign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Its number, from 1.
    number: usize,
    /// Number of shards.
    count: usize,
}

impl Shard {
    /// The complete campaign.
    pub const ALL: Self = Self { number: 1, count: 1 };

    /// Decides whether the shard executes a run.
    pub fn contains(self, index: usize) -> bool {
        index % self.count == self.number - 1
    }

    /// Returns a folder name: `shard-2-of-4`.
    pub fn folder(self) -> String {
        format!("shard-{}-of-{}", self.number, self.count)
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.count)
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let shard = text.split_once('/').and_then(|(number, count)| {
            let shard = Self { number: number.parse().ok()?, count: count.parse().ok()? };
            let is_valid = (1..=shard.count).contains(&shard.number) && shard.count <= MAX_SHARDS;
            is_valid.then_some(shard)
        });
        shard.ok_or_else(|| format!("found `{text}`; expected I/N with 1 <= I <= N <= {MAX_SHARDS}"))
    }
}

/// A result that knows the number of its run.
pub trait Numbered {
    /// Number of the run, from 0.
    fn number(&self) -> usize;
}

/// Why shards cannot be merged.
#[derive(Debug, thiserror::Error)]
pub enum MergeError {
    /// A journal is unusable or belongs to another campaign.
    #[error("{0}")]
    Journal(#[from] JournalError),
    /// A folder has no journal.
    #[error("{}: found no journal; expected that of a shard", .0.display())]
    NoJournal(PathBuf),
    /// A journal contains a run that the campaign does not have.
    #[error("{}: found run {index}; expected 0 to {}", file.display(), count.saturating_sub(1))]
    Outside {
        /// The journal.
        file: PathBuf,
        /// Number of the run.
        index: usize,
        /// Number of runs of the campaign.
        count: usize,
    },
    /// A run occurs twice.
    #[error("run {index}: found it in {} and in {}; expected it once", first.display(), second.display())]
    Twice {
        /// Number of the run.
        index: usize,
        /// First journal.
        first: PathBuf,
        /// Second journal, which may be the same.
        second: PathBuf,
    },
    /// Runs are missing.
    #[error("found {} of {count} runs; missing: {}", count - missing.len(), named(missing))]
    Missing {
        /// Numbers of the missing runs.
        missing: Vec<usize>,
        /// Number of runs of the campaign.
        count: usize,
    },
}

fn named(missing: &[usize]) -> String {
    let mut text = missing.iter().take(NAMED).map(usize::to_string).collect::<Vec<_>>().join(", ");
    if missing.len() > NAMED {
        text.push_str(&format!(" and {} more", missing.len() - NAMED));
    }
    text
}

/// Reads the journals `NAME` of some folders and returns the results of all `count` runs in order.
/// They are to be written to the folder `out`.
///
/// # Errors
///
/// A journal is missing, in use or of another campaign, or that in `out` is of another campaign; a
/// run is missing or occurs twice.
pub fn merge<R: DeserializeOwned + Numbered>(
    folders: &[PathBuf],
    out: &Path,
    name: &str,
    header: &impl Serialize,
    count: usize,
) -> Result<Vec<R>, MergeError> {
    let own = out.join(name);
    if own.is_file() {
        Journal::read::<R>(&own, header)?;
    }
    let mut found: BTreeMap<usize, (&Path, R)> = BTreeMap::new();
    for folder in folders {
        let file = folder.join(name);
        if !file.is_file() {
            return Err(MergeError::NoJournal(file));
        }
        for result in Journal::read::<R>(&file, header)? {
            let index = result.number();
            if index >= count {
                return Err(MergeError::Outside { file, index, count });
            }
            if let Some((first, _)) = found.insert(index, (folder, result)) {
                return Err(MergeError::Twice { index, first: first.join(name), second: file });
            }
        }
    }
    let missing: Vec<usize> = (0..count).filter(|index| !found.contains_key(index)).collect();
    if missing.is_empty() {
        Ok(found.into_values().map(|(_, result)| result).collect())
    } else {
        Err(MergeError::Missing { missing, count })
    }
}

impl From<MergeError> for CliError {
    fn from(error: MergeError) -> Self {
        match error {
            MergeError::Journal(error) => error.into(),
            _ => Self::Input(error.to_string()),
        }
    }
}

/// Result of a shard as JSON.
#[derive(Serialize, JsonSchema)]
pub(crate) struct Outcome {
    /// The shard: I/N.
    shard: String,
    /// Number of runs of the shard; its journal contains them all.
    runs: usize,
    /// Number of runs of the campaign.
    campaign_runs: usize,
    /// Number of failed runs of the shard. The journal contains the reasons.
    failed: usize,
    /// Path of the journal.
    journal: String,
}

/// Prints the result of a shard with the numbers of its runs, of the campaign's runs and of failed
/// runs. A failed run is a result, too: to run it again would not change it.
pub(crate) fn report(
    shard: Shard,
    [runs, campaign_runs, failed]: [usize; 3],
    journal: &Path,
    json: bool,
) -> Result<(), CliError> {
    let journal = journal.display().to_string();
    if json {
        let outcome = Outcome { shard: shard.to_string(), runs, campaign_runs, failed, journal };
        print_result!("{}", output::json(&outcome)?);
    } else {
        print_line!("shard {shard}: {runs} of {campaign_runs} runs, {failed} failed; journal: {journal}");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    impl Numbered for (usize, f64) {
        fn number(&self) -> usize {
            self.0
        }
    }

    #[test]
    fn shards_partition_the_runs_and_only_valid_ones_are_accepted() {
        let shard = |text: &str| text.parse::<Shard>();
        assert_eq!(shard("1/1"), Ok(Shard::ALL));
        let shards = ["1/3", "2/3", "3/3"].map(|text| shard(text).unwrap());
        for index in 0..20 {
            let owners: Vec<usize> = (0..3).filter(|i| shards[*i].contains(index)).collect();
            assert_eq!(owners, [index % 3]);
        }
        assert_eq!((shards[1].to_string(), shards[1].folder()), ("2/3".into(), "shard-2-of-3".into()));
        for wrong in ["", "1", "0/2", "3/2", "1/0", "-1/2", "1/100001", "1/2/3", "a/b"] {
            assert!(shard(wrong).unwrap_err().contains("expected I/N"), "{wrong}");
        }
    }

    #[test]
    fn a_merge_needs_every_run_exactly_once_from_one_campaign() {
        let root = tempfile::tempdir().unwrap();
        let folder = |name: &str| root.path().join(name);
        let header = |seed: u32| serde_json::json!({ "seed": seed });
        let write = |name: &str, seed: u32, runs: &[usize]| {
            let (mut journal, _) =
                Journal::open::<(usize, f64)>(&folder(name).join("j"), &header(seed)).unwrap();
            runs.iter().for_each(|run| journal.append(&(*run, *run as f64 / 3.0)).unwrap());
        };
        let merged_into = |out: &str, names: &[&str], count| {
            let folders: Vec<PathBuf> = names.iter().map(|name| folder(name)).collect();
            merge::<(usize, f64)>(&folders, &folder(out), "j", &header(1), count)
                .map_err(|error| error.to_string())
        };
        let merged = |names: &[&str], count| merged_into("out", names, count);
        write("a", 1, &[2, 0]);
        write("b", 1, &[3, 1]);
        write("other", 2, &[1, 3]);
        let expected: Vec<(usize, f64)> = (0..4).map(|run| (run, run as f64 / 3.0)).collect();
        assert_eq!(merged(&["b", "a"], 4), Ok(expected));
        let refused = |names: &[&str], count, reason: &str| {
            let error = merged(names, count).unwrap_err();
            assert!(error.contains(reason), "{error}");
        };
        refused(&["a", "b"], 5, "found 4 of 5 runs; missing: 4");
        refused(&["a"], 20, "found 2 of 20 runs; missing: 1, 3, 4, 5, 6, 7, 8, 9, 10, 11 and 8 more");
        refused(&["a", "b"], 3, "found run 3; expected 0 to 2");
        refused(&["a", "a"], 4, "run 2: found it in ");
        refused(&["a", "other"], 4, "it belongs to other work: seed: found 2, expected 1");
        refused(&["a", "none"], 4, "none/j: found no journal");
        let error = merged_into("other", &["a", "b"], 4).unwrap_err();
        assert!(error.contains("it belongs to other work"), "{error}");
        write("a", 1, &[2]);
        refused(&["a", "b"], 4, "run 2: found it in ");
        // A shard that is still running.
        let open = Journal::open::<(usize, f64)>(&folder("b").join("j"), &header(1)).unwrap();
        refused(&["b", "a"], 4, "another process is writing it");
        drop(open);
    }
}
