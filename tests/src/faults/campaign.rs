//! Many faults on all cores. Each outcome is appended to a file as it comes, so that a campaign that was ended goes on where it was.

use super::CampaignError;
use super::attempt::attempt;
use super::image::Image;
use super::judge::Outcome;
use super::plan::Fault;
use super::stage::Stage;
use super::trace::{Step, trace};
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// What all faults share.
#[derive(Debug)]
pub struct Campaign {
    elf: PathBuf,
    seed: u64,
    image: Image,
    stage: Stage,
    trace: Vec<Step>,
}

impl Campaign {
    /// Simulates the bench, reads the image and traces a sample.
    pub fn prepare(elf: &Path, seed: u64) -> Result<Self, CampaignError> {
        let expected = "the image that `cargo xtask firmware` builds";
        let elf = elf.canonicalize().map_err(|_| CampaignError::Image { path: elf.into(), expected })?;
        let image = Image::read(&elf)?;
        let stage = Stage::new(seed)?;
        let trace = trace(&elf, &image, &stage)?;
        Ok(Self { elf, seed, image, stage, trace })
    }

    /// Instructions of a sample, and addresses among them.
    #[must_use]
    pub fn traced(&self) -> (usize, usize) {
        (self.trace.len(), self.trace.iter().filter(|step| step.before == 0).count())
    }

    /// Carries out one fault.
    pub fn fault(&self, number: u64) -> Result<Outcome, CampaignError> {
        let fault = Fault::new(self.seed, number, &self.image, &self.trace);
        attempt(&self.elf, &self.image, &self.stage, &fault)
    }

    /// Carries out the faults of the given numbers that are not among the outcomes of a file, and returns all, by number.
    pub fn run(
        &self,
        numbers: std::ops::Range<u64>,
        record: Option<&Path>,
        done: impl Fn(&Outcome) + Sync,
    ) -> Result<Vec<Outcome>, CampaignError> {
        let mut known = BTreeMap::new();
        if let Some(path) = record {
            for outcome in recorded(path)? {
                known.insert(outcome.number, outcome);
            }
        }
        known.retain(|number, _| numbers.contains(number));
        known.values().for_each(&done);
        let file = record.map(reopen).transpose()?.map(Mutex::new);
        let left: Vec<u64> = numbers.filter(|number| !known.contains_key(number)).collect();
        let outcomes = left.into_par_iter().map(|number| {
            let outcome = self.fault(number)?;
            if let (Some(file), Some(path)) = (&file, record) {
                append(file, path, &outcome)?;
            }
            done(&outcome);
            Ok((number, outcome))
        });
        let outcomes = outcomes.collect::<Result<Vec<_>, CampaignError>>()?;
        known.extend(outcomes);
        Ok(known.into_values().collect())
    }
}

fn cannot(path: &Path, found: String) -> CampaignError {
    CampaignError::File { path: path.into(), found, expected: "a file of outcomes, one a line" }
}

/// Opens a file of outcomes behind its last whole line.
fn reopen(path: &Path) -> Result<File, CampaignError> {
    let failed = |error: std::io::Error| cannot(path, error.to_string());
    let file = OpenOptions::new().read(true).append(true).create(true).open(path).map_err(failed)?;
    let text = std::fs::read(path).map_err(failed)?;
    let whole = text.iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1);
    file.set_len(whole as u64).map_err(failed)?;
    Ok(file)
}

fn append(file: &Mutex<File>, path: &Path, outcome: &Outcome) -> Result<(), CampaignError> {
    let text = serde_json::to_string(outcome).map_err(|error| cannot(path, error.to_string()))? + "\n";
    let mut file = file.lock().map_err(|_| cannot(path, "a writer that failed".into()))?;
    file.write_all(text.as_bytes()).map_err(|error| cannot(path, error.to_string()))
}

/// The outcomes of a file; none if there is none. A last line that is not whole was being written when the campaign ended.
fn recorded(path: &Path) -> Result<Vec<Outcome>, CampaignError> {
    let text = match std::fs::read_to_string(path) {
        Ok(text) => text,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(vec![]),
        Err(error) => return Err(cannot(path, error.to_string())),
    };
    let whole = text.rfind('\n').map_or("", |end| text.get(..end).unwrap_or_default());
    let line = |(index, line): (usize, &str)| {
        serde_json::from_str(line).map_err(|error| cannot(path, format!("line {}: {error}", index + 1)))
    };
    whole.lines().enumerate().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::faults::judge::Class;
    use crate::faults::plan::Kind;

    #[test]
    fn a_campaign_goes_on_behind_its_last_whole_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("outcomes");
        assert_eq!(recorded(&path).unwrap(), []);
        let outcome = Outcome {
            number: 7,
            kind: Kind::Code,
            what: "bit 3".into(),
            class: Class::DetectedLate,
            told: Some("stuck".into()),
            latency: Some(4),
            late: Some(3),
            error_share: f64::MAX,
            wrong: 3,
            alive: true,
        };
        let file = Mutex::new(reopen(&path).unwrap());
        append(&file, &path, &outcome).unwrap();
        append(&file, &path, &outcome).unwrap();
        file.lock().unwrap().write_all(b"{\"number\":8,\"ki").unwrap();
        assert_eq!(recorded(&path).unwrap(), [outcome.clone(), outcome.clone()]);
        append(&Mutex::new(reopen(&path).unwrap()), &path, &outcome).unwrap();
        assert_eq!(recorded(&path).unwrap().len(), 3, "the half line is gone");
        std::fs::write(&path, "no outcome\n").unwrap();
        assert!(recorded(&path).unwrap_err().to_string().contains("line 1"));
    }
}
