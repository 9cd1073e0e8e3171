//! Many faults on all cores. Outcomes are appended to a journal, so that an interrupted campaign
//! can continue.

use super::CampaignError;
use super::attempt::attempt;
use super::classify::Outcome;
use super::image::Image;
use super::plan::{Fault, Step};
use super::scenario::Scenario;
use super::trace::trace;
use crate::journal::{self, checksum};
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Identity of a campaign: with the number, it determines a fault.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Identity {
    seed: u64,
    image: u32,
}

/// Data that all faults share.
#[derive(Debug)]
pub struct Campaign {
    elf: PathBuf,
    seed: u64,
    image: Image,
    scenario: Scenario,
    trace: Vec<Step>,
}

impl Campaign {
    /// Simulates the bench, reads the image and traces a sample.
    pub fn prepare(elf: &Path, seed: u64) -> Result<Self, CampaignError> {
        let expected = "the image that `cargo xtask firmware` builds";
        let elf = elf.canonicalize().map_err(|_| CampaignError::Image { path: elf.into(), expected })?;
        let image = Image::read(&elf)?;
        let scenario = Scenario::new(seed)?;
        let trace = trace(&elf, &image, &scenario)?;
        Ok(Self { elf, seed, image, scenario, trace })
    }

    /// Returns the instructions of a sample and the distinct addresses among them.
    #[must_use]
    pub fn traced(&self) -> (usize, usize) {
        (self.trace.len(), self.trace.iter().filter(|step| step.before == 0).count())
    }

    /// Injects one fault.
    pub fn fault(&self, number: u64) -> Result<Outcome, CampaignError> {
        let fault = Fault::new(self.seed, number, &self.image, &self.trace);
        attempt(&self.elf, &self.image, &self.scenario, &fault)
    }

    /// Injects the faults that the journal does not hold yet, and returns the outcomes of all by
    /// number.
    pub fn run(
        &self,
        numbers: std::ops::Range<u64>,
        record: Option<&Path>,
        done: impl Fn(&Outcome) + Sync,
    ) -> Result<Vec<Outcome>, CampaignError> {
        let mut known = BTreeMap::new();
        let mut journal = None;
        if let Some(path) = record {
            let identity = Identity { seed: self.seed, image: checksum(&self.elf)? };
            let (file, outcomes) = journal::open::<_, Outcome>(path, identity)?;
            known.extend(outcomes.into_iter().map(|outcome| (outcome.number, outcome)));
            journal = Some(Mutex::new(file));
        }
        known.retain(|number, _| numbers.contains(number));
        known.values().for_each(&done);
        let left: Vec<u64> = numbers.filter(|number| !known.contains_key(number)).collect();
        let outcomes = left.into_par_iter().map(|number| {
            let outcome = self.fault(number)?;
            if let Some(journal) = &journal {
                journal.lock().unwrap_or_else(PoisonError::into_inner).append(&outcome)?;
            }
            done(&outcome);
            Ok((number, outcome))
        });
        let outcomes = outcomes.collect::<Result<Vec<_>, CampaignError>>()?;
        known.extend(outcomes);
        Ok(known.into_values().collect())
    }
}
