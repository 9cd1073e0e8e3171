//! Published campaigns. Each has a seed that no campaign before it has used, so that no fault of it
//! can have shaped the controller.

use super::CampaignError;
use super::table::Table;
use host_sim::controller::{Controller, EmulatedController};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// A published campaign.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Publication {
    /// Day, `YYYY-MM-DD`.
    pub date: String,
    /// Name of the image's build.
    pub build: String,
    /// Seed of the campaign.
    pub seed: u64,
    /// Number of faults, from number 0.
    pub count: u64,
    /// Counts.
    pub table: Table,
}

/// File of the publications, the last one at the end.
#[must_use]
pub fn path() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("golden/faults-published.json")
}

/// Reads the publications.
///
/// # Errors
///
/// The file cannot be read, or does not contain publications.
pub fn read() -> Result<Vec<Publication>, CampaignError> {
    let failed =
        |source| CampaignError::System { what: "reading tests/golden/faults-published.json", source };
    let text = std::fs::read_to_string(path()).map_err(failed)?;
    serde_json::from_str(&text).map_err(|error| failed(error.into()))
}

/// Returns the seed of a new publication: the given one, or a random one.
///
/// # Errors
///
/// The given seed has been published, or the system has no random numbers.
pub fn fresh_seed(given: Option<u64>) -> Result<u64, CampaignError> {
    let published = read()?;
    let is_fresh = |seed| published.iter().all(|publication| publication.seed != seed);
    if let Some(seed) = given {
        let refused = CampaignError::NotFresh { seed };
        return if is_fresh(seed) { Ok(seed) } else { Err(refused) };
    }
    loop {
        let failed =
            |error: getrandom::Error| CampaignError::System { what: "drawing a seed", source: error.into() };
        let seed = getrandom::u32().map_err(failed)?.into();
        if is_fresh(seed) {
            return Ok(seed);
        }
    }
}

/// Returns the name of an image's build.
///
/// # Errors
///
/// The image does not start, or its sources had changes that are not in a commit.
pub fn build_of(elf: &Path) -> Result<String, CampaignError> {
    let build = EmulatedController::open(elf)?.hello().build_id.as_str().to_owned();
    if build.ends_with("-dirty") {
        return Err(CampaignError::NotCommitted { build });
    }
    Ok(build)
}

/// Appends a publication of today to the file.
///
/// # Errors
///
/// The file cannot be read or written.
pub fn publish(build: String, seed: u64, count: u64, table: Table) -> Result<(), CampaignError> {
    let date = chrono::Utc::now().format("%Y-%m-%d").to_string();
    let mut publications = read()?;
    publications.push(Publication { date, build, seed, count, table });
    let text = serde_json::to_string_pretty(&publications).unwrap_or_default() + "\n";
    bench::atomic::write(&path(), text.as_bytes()).map_err(|source| CampaignError::System {
        what: "writing tests/golden/faults-published.json",
        source,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn no_two_publications_have_one_seed_and_a_used_one_is_refused() {
        let published = read().unwrap();
        let seeds: BTreeSet<u64> = published.iter().map(|publication| publication.seed).collect();
        assert_eq!(seeds.len(), published.len());
        for seed in seeds {
            assert!(matches!(fresh_seed(Some(seed)), Err(CampaignError::NotFresh { .. })));
        }
        assert!(published.iter().all(|p| u64::from(p.table.all.faults) == p.count));
    }
}
