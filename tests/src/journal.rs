//! The journal of a campaign: a header that says which one, then one line of JSON a result, in any order.
//!
//! A line counts once its newline is there; half a line at the end is cut off on the next start, so a kill costs what was
//! under way. The header holds the check sum of the running program beside what the campaign says of itself: results of another
//! program are of another campaign. While a process has it open no other gets it.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::fs::{File, OpenOptions};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::Path;

/// Check sum of files: that of Ethernet.
const CRC: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);

/// Why a journal cannot be gone on with.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// It is not this campaign's.
    #[error("{file}: found {found}; expected the journal of this very campaign: remove it or choose another")]
    Other {
        /// Its path.
        file: String,
        /// What was found.
        found: String,
    },
    /// It cannot be read or written.
    #[error("{file}: {source}")]
    Unusable {
        /// Its path.
        file: String,
        /// What the system says.
        source: std::io::Error,
    },
}

/// What the first line says.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Header<C> {
    campaign: C,
    program: u32,
}

/// An open journal.
#[derive(Debug)]
pub struct Journal {
    file: File,
    name: String,
}

impl Journal {
    /// Opens the journal of a campaign, new or begun before; gives the results that it has.
    pub fn open<C, R>(path: &Path, campaign: C) -> Result<(Self, Vec<R>), JournalError>
    where
        C: Serialize + DeserializeOwned + PartialEq + std::fmt::Debug,
        R: DeserializeOwned,
    {
        let name = path.display().to_string();
        let failed = |source| JournalError::Unusable { file: name.clone(), source };
        let program = std::env::current_exe().map_err(failed)?;
        let header = Header { campaign, program: check_sum(&program)? };
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(failed)?;
        }
        let mut options = OpenOptions::new();
        let mut file =
            options.read(true).write(true).create(true).truncate(false).open(path).map_err(failed)?;
        rustix::fs::flock(&file, rustix::fs::FlockOperation::NonBlockingLockExclusive)
            .map_err(|e| failed(e.into()))?;
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(failed)?;
        let whole = bytes.iter().rposition(|b| *b == b'\n').map_or(0, |at| at + 1);
        bytes.truncate(whole);
        let mut lines = bytes.split(|b| *b == b'\n').enumerate().filter(|(_, line)| !line.is_empty());
        let other = |found| JournalError::Other { file: name.clone(), found };
        let damaged =
            |number: usize| move |error: serde_json::Error| other(format!("line {}: {error}", number + 1));
        let first = lines.next();
        if let Some((number, line)) = first {
            let found: Header<C> = serde_json::from_slice(line).map_err(damaged(number))?;
            if found.campaign != header.campaign {
                return Err(other(format!("that of another campaign ({:?})", found.campaign)));
            }
            if found != header {
                return Err(other("that of another build of this program".into()));
            }
        }
        let result = |(number, line): (usize, &[u8])| serde_json::from_slice(line).map_err(damaged(number));
        let results: Vec<R> = lines.map(result).collect::<Result<_, _>>()?;
        // Nothing is cut off a file that is none of this campaign's.
        file.set_len(whole as u64).map_err(failed)?;
        file.seek(SeekFrom::End(0)).map_err(failed)?;
        let mut journal = Self { file, name: name.clone() };
        if first.is_none() {
            journal.line(&header)?;
        }
        Ok((journal, results))
    }

    /// Adds a line.
    pub fn line(&mut self, value: &impl Serialize) -> Result<(), JournalError> {
        let failed = |source| JournalError::Unusable { file: self.name.clone(), source };
        let mut line = serde_json::to_vec(value).map_err(|e| failed(e.into()))?;
        line.push(b'\n');
        self.file.write_all(&line).map_err(failed)
    }
}

/// Check sum of a file.
pub fn check_sum(path: &Path) -> Result<u32, JournalError> {
    let bytes = std::fs::read(path)
        .map_err(|source| JournalError::Unusable { file: path.display().to_string(), source })?;
    Ok(CRC.checksum(&bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_journal_goes_on_after_half_a_line_and_refuses_what_is_not_its_own() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/journal.jsonl");
        let open = |campaign: u32| Journal::open::<u32, (u32, f64)>(&path, campaign);
        let (mut journal, results) = open(2).unwrap();
        assert_eq!(results, []);
        assert!(open(2).unwrap_err().to_string().contains("journal.jsonl"), "it is open");
        journal.line(&(7, f64::MAX)).unwrap();
        journal.file.write_all(b"[8,").unwrap();
        drop(journal);
        let (mut journal, results) = open(2).unwrap();
        assert_eq!(results, [(7, f64::MAX)]);
        journal.line(&(8, 0.5)).unwrap();
        drop(journal);
        assert_eq!(open(2).unwrap().1.len(), 2, "the half line is gone");
        let refused = open(3).unwrap_err().to_string();
        assert!(refused.contains("another campaign"), "{refused}");
        let text = std::fs::read_to_string(&path).unwrap();
        let header = text.lines().next().unwrap();
        let program = format!("\"program\":{}", check_sum(&std::env::current_exe().unwrap()).unwrap());
        assert!(header.contains(&program), "{header}");
        std::fs::write(&path, text.replacen(&program, "\"program\":1", 1)).unwrap();
        let refused = open(2).unwrap_err().to_string();
        assert!(refused.contains("another build"), "{refused}");
        std::fs::write(&path, format!("{header}\nno result\n")).unwrap();
        assert!(open(2).unwrap_err().to_string().contains("line 2"));
        std::fs::write(&path, "\n[7,0.5]\n").unwrap();
        assert!(
            open(2).unwrap_err().to_string().contains("line 2"),
            "what stands behind an empty line is the header"
        );
        std::fs::write(&path, "somebody's notes\n").unwrap();
        assert!(open(2).unwrap_err().to_string().contains("line 1"));
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "somebody's notes\n");
    }
}
