//! The journal of a campaign: a header that says which one, then one line of JSON a finished cell, in any order.
//!
//! A line counts once its newline is there; half a line at the end is cut off on the next start, so a kill costs the
//! cells that were under way.

use super::CampaignError;
use super::cell::Campaign;
use super::compare::Outcome;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::Path;

/// An open journal.
pub struct Journal {
    file: File,
    name: String,
}

impl Journal {
    /// Opens the journal of a campaign in a folder, new or begun before; gives the finished cells by number.
    pub fn open(
        folder: &Path,
        campaign: &Campaign,
    ) -> Result<(Self, BTreeMap<usize, Outcome>), CampaignError> {
        let path = folder.join("journal.jsonl");
        let name = path.display().to_string();
        let failed = |e: std::io::Error| CampaignError::File {
            file: name.clone(),
            found: e.to_string(),
            expected: "a journal that can be written",
        };
        std::fs::create_dir_all(folder).map_err(failed)?;
        let mut options = OpenOptions::new();
        let mut file =
            options.read(true).write(true).create(true).truncate(false).open(&path).map_err(failed)?;
        rustix::fs::flock(&file, rustix::fs::FlockOperation::NonBlockingLockExclusive)
            .map_err(|e| failed(e.into()))?;
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(failed)?;
        let whole = bytes.iter().rposition(|b| *b == b'\n').map_or(0, |at| at + 1);
        file.set_len(whole as u64).map_err(failed)?;
        file.seek(SeekFrom::End(0)).map_err(failed)?;
        bytes.truncate(whole);
        let mut lines = bytes.split(|b| *b == b'\n').filter(|l| !l.is_empty());
        let mut journal = Self { file, name: name.clone() };
        let Some(header) = lines.next() else {
            journal.line(campaign)?;
            return Ok((journal, BTreeMap::new()));
        };
        let damaged = |found: String| CampaignError::File {
            file: name.clone(),
            found,
            expected: "the journal of this very campaign; remove it or choose another --out",
        };
        let found: Campaign = serde_json::from_slice(header).map_err(|e| damaged(e.to_string()))?;
        if found != *campaign {
            return Err(damaged(format!("that of another campaign ({found:?})")));
        }
        let mut finished = BTreeMap::new();
        for line in lines {
            let outcome: Outcome = serde_json::from_slice(line).map_err(|e| damaged(e.to_string()))?;
            finished.insert(outcome.cell.index, outcome);
        }
        Ok((journal, finished))
    }

    /// Adds a line.
    pub fn line(&mut self, value: &impl Serialize) -> Result<(), CampaignError> {
        let failed = |found: String| CampaignError::File {
            file: self.name.clone(),
            found,
            expected: "a journal that can be written",
        };
        let mut line = serde_json::to_vec(value).map_err(|e| failed(e.to_string()))?;
        line.push(b'\n');
        self.file.write_all(&line).map_err(|e| failed(e.to_string()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generator::session::Plant;
    use crate::hidden_effects::cell::Arm;

    #[test]
    fn a_journal_goes_on_after_half_a_line_and_refuses_another_campaign() {
        let folder = tempfile::tempdir().unwrap();
        let campaign = |seeds| Campaign {
            seeds,
            bench_seeds: 0,
            plants: vec![Plant::Linear],
            sizes: vec![1.0],
            arms: vec![Arm::Clean],
        };
        let (mut journal, finished) = Journal::open(folder.path(), &campaign(2)).unwrap();
        assert!(finished.is_empty());
        journal.line(&Outcome::new(&campaign(2).cells()[7])).unwrap();
        journal.file.write_all(b"{\"cell\":").unwrap();
        drop(journal);
        let (_, finished) = Journal::open(folder.path(), &campaign(2)).unwrap();
        assert_eq!(finished.keys().copied().collect::<Vec<_>>(), [7]);
        let refused = Journal::open(folder.path(), &campaign(3)).err().unwrap().to_string();
        assert!(refused.contains("another campaign"), "{refused}");
    }
}
