//! Published campaigns. The seed of each is drawn when it begins, and it is recorded before the
//! first fault, so that a campaign with an unwelcome result cannot be replaced by another one
//! unseen.

use super::CampaignError;
use super::table::Table;
use host_sim::controller::{Controller, EmulatedController};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Seeds of the campaigns before this record.
const EARLIER_SEEDS: [u64; 2] = [1, 20_261_127];
/// File of the publications, relative to the workspace.
const FILE: &str = "tests/golden/faults-published.json";

/// A campaign that is published, whatever its result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Publication {
    /// Day of its begin, `YYYY-MM-DD`.
    pub date: String,
    /// Name of the image's build.
    pub build: String,
    /// Seed of the campaign.
    pub seed: u64,
    /// Number of faults, from number 0.
    pub count: u64,
    /// Counts; `None` until it has ended.
    pub table: Option<Table>,
}

fn workspace() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn failed(what: &'static str) -> impl Fn(std::io::Error) -> CampaignError {
    move |source| CampaignError::System { what, source }
}

/// Reads the publications, the last one at the end.
///
/// # Errors
///
/// The file cannot be read, or does not contain publications.
pub fn read() -> Result<Vec<Publication>, CampaignError> {
    let failed = failed("reading tests/golden/faults-published.json");
    let text = std::fs::read_to_string(workspace().join(FILE)).map_err(&failed)?;
    serde_json::from_str(&text).map_err(|error| failed(error.into()))
}

fn write(publications: &[Publication]) -> Result<(), CampaignError> {
    let failed = failed("writing tests/golden/faults-published.json");
    let text = serde_json::to_string_pretty(publications).map_err(|error| failed(error.into()))? + "\n";
    bench::atomic::write(&workspace().join(FILE), text.as_bytes()).map_err(failed)
}

/// Returns whether no campaign has used a seed.
fn is_fresh(published: &[Publication], seed: u64) -> bool {
    !EARLIER_SEEDS.contains(&seed) && published.iter().all(|publication| publication.seed != seed)
}

/// Begins a publication and returns its seed: a random one, or that of a publication of the same
/// build and count that has not ended.
///
/// # Errors
///
/// There is no such publication, or the system has no random numbers.
pub fn begin(continued: Option<u64>, build: String, count: u64) -> Result<u64, CampaignError> {
    let mut published = read()?;
    if let Some(seed) = continued {
        let is_open =
            |p: &Publication| p.seed == seed && p.table.is_none() && p.build == build && p.count == count;
        let found = published.iter().any(is_open).then_some(seed);
        return found.ok_or(CampaignError::NotBegun { seed });
    }
    let seed = loop {
        let seed = getrandom::u32().map_err(|error| failed("drawing a seed")(error.into()))?.into();
        if is_fresh(&published, seed) {
            break seed;
        }
    };
    let date = chrono::Utc::now().format("%Y-%m-%d").to_string();
    published.push(Publication { date, build, seed, count, table: None });
    write(&published)?;
    Ok(seed)
}

/// Ends the publication with a seed.
///
/// # Errors
///
/// The file cannot be read or written.
pub fn end(seed: u64, table: Table) -> Result<(), CampaignError> {
    let mut published = read()?;
    let open = published.iter_mut().find(|publication| publication.seed == seed);
    open.ok_or(CampaignError::NotBegun { seed })?.table = Some(table);
    write(&published)
}

/// Returns the name of an image's build, which must be the commit of this workspace without other
/// changes than the record of publications.
///
/// # Errors
///
/// It is not, or the image does not start.
pub fn build_of(elf: &Path) -> Result<String, CampaignError> {
    let build = EmulatedController::open(elf)?.hello().build_id.as_str().to_owned();
    let git = |arguments: &[&str]| -> Result<String, CampaignError> {
        let output = Command::new("git").args(arguments).current_dir(workspace()).output();
        let output = output.map_err(failed("asking git for the commit"))?;
        Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    let commit = git(&["describe", "--always", "--tags"])?;
    let exception = format!(":(exclude){FILE}");
    let changes = git(&["status", "--porcelain", "--untracked-files=no", "--", ".", &exception])?;
    if build == commit && changes.is_empty() {
        return Ok(build);
    }
    let found = if changes.is_empty() { "none" } else { "some" };
    Err(CampaignError::NotCommitted { build, commit, changes: found })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn no_two_publications_have_one_seed_and_each_that_has_ended_is_complete() {
        let published = read().unwrap();
        let seeds: BTreeSet<u64> = published.iter().map(|publication| publication.seed).collect();
        assert_eq!(seeds.len(), published.len());
        for publication in &published {
            assert!(!is_fresh(&published, publication.seed));
            let faults = publication.table.as_ref().map(|table| u64::from(table.all.faults));
            assert!(faults.is_none_or(|faults| faults == publication.count));
        }
    }

    #[test]
    fn a_used_seed_is_neither_fresh_nor_continued() {
        for seed in EARLIER_SEEDS {
            assert!(!is_fresh(&[], seed));
            assert!(matches!(begin(Some(seed), "any".into(), 300), Err(CampaignError::NotBegun { .. })));
        }
        assert!(is_fresh(&[], 2));
    }
}
