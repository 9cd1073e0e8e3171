//! A journal of results: a header that identifies the work, then one line of JSON per result, in
//! any order.
//!
//! A line counts once its newline is written. An incomplete line at the end is cut off on the next
//! start, so a killed program loses only the results that were being computed. While one process
//! has the journal open, no other process gets it. A power cut may cost lines that the system had
//! not yet written to the disk.

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::Path;

/// Why a journal cannot be continued.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// It belongs to other work, or is damaged. Nothing was changed in the file.
    #[error("{file}, line {line}: {found}; remove the journal or choose another folder")]
    Other {
        /// Its path.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Description of what was found there.
        found: String,
    },
    /// Another process has it open.
    #[error("{file}: another process is writing it")]
    Locked {
        /// Its path.
        file: String,
    },
    /// It cannot be read or written.
    #[error("{file}: {source}")]
    Unusable {
        /// Its path.
        file: String,
        /// Error of the system.
        source: std::io::Error,
    },
}

/// An open journal.
#[derive(Debug)]
pub struct Journal {
    file: File,
    name: String,
}

impl Journal {
    /// Opens a journal, new or existing, and returns the results in it.
    ///
    /// # Errors
    ///
    /// The file is locked or unusable, or its header or one of its lines does not fit.
    pub fn open<R: DeserializeOwned>(
        path: &Path,
        header: &impl Serialize,
    ) -> Result<(Self, Vec<R>), JournalError> {
        let name = path.display().to_string();
        let failed = |source| JournalError::Unusable { file: name.clone(), source };
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(failed)?;
        }
        let mut options = OpenOptions::new();
        options.read(true).write(true).create(true).truncate(false);
        let mut file = options.open(path).map_err(failed)?;
        file.try_lock().map_err(|error| match error {
            TryLockError::WouldBlock => JournalError::Locked { file: name.clone() },
            TryLockError::Error(source) => failed(source),
        })?;
        let mut text = Vec::new();
        file.read_to_end(&mut text).map_err(failed)?;
        let complete = complete_length(&text);
        let header = serde_json::to_value(header).map_err(|e| failed(e.into()))?;
        let results = read(&name, text.get(..complete).unwrap_or_default(), &header)?;
        // Cut only now: a file that belongs to other work stays as it is.
        file.set_len(complete as u64).map_err(failed)?;
        file.seek(SeekFrom::End(0)).map_err(failed)?;
        let mut journal = Self { file, name };
        if complete == 0 {
            journal.append(&header)?;
        }
        Ok((journal, results))
    }

    /// Returns the results of a complete journal, without opening it for writing.
    ///
    /// # Errors
    ///
    /// As for [`Self::open`]; an incomplete last line is left out.
    pub fn read<R: DeserializeOwned>(path: &Path, header: &impl Serialize) -> Result<Vec<R>, JournalError> {
        let name = path.display().to_string();
        let failed = |source| JournalError::Unusable { file: name.clone(), source };
        let mut file = File::open(path).map_err(failed)?;
        file.try_lock_shared().map_err(|error| match error {
            TryLockError::WouldBlock => JournalError::Locked { file: name.clone() },
            TryLockError::Error(source) => failed(source),
        })?;
        let mut text = Vec::new();
        file.read_to_end(&mut text).map_err(failed)?;
        let header = serde_json::to_value(header).map_err(|e| failed(e.into()))?;
        read(&name, text.get(..complete_length(&text)).unwrap_or_default(), &header)
    }

    /// Appends a result.
    ///
    /// # Errors
    ///
    /// The line cannot be written.
    pub fn append(&mut self, result: &impl Serialize) -> Result<(), JournalError> {
        let failed = |source| JournalError::Unusable { file: self.name.clone(), source };
        let mut line = serde_json::to_vec(result).map_err(|e| failed(e.into()))?;
        line.push(b'\n');
        self.file.write_all(&line).map_err(failed)
    }
}

/// Returns the length of the complete lines.
fn complete_length(text: &[u8]) -> usize {
    text.iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1)
}

/// Parses the complete lines of a journal.
fn read<R: DeserializeOwned>(name: &str, text: &[u8], header: &Value) -> Result<Vec<R>, JournalError> {
    let other = |line, found| JournalError::Other { file: name.into(), line, found };
    let lines = text.split(|byte| *byte == b'\n').zip(1..);
    let mut lines = lines.filter(|(line, _)| !line.is_empty());
    let Some((first, number)) = lines.next() else { return Ok(Vec::new()) };
    let found: Value =
        serde_json::from_slice(first).map_err(|e| other(number, format!("found no header ({e})")))?;
    if let Some(difference) = difference("", &found, header) {
        return Err(other(number, format!("it belongs to other work: {difference}")));
    }
    let result = |(line, number): (&[u8], usize)| {
        serde_json::from_slice(line).map_err(|e| other(number, format!("found no result ({e})")))
    };
    lines.map(result).collect()
}

/// Describes the first field in which two headers differ.
fn difference(path: &str, found: &Value, expected: &Value) -> Option<String> {
    match (found, expected) {
        _ if found == expected => None,
        (Value::Object(a), Value::Object(b)) => {
            let keys: BTreeSet<&String> = a.keys().chain(b.keys()).collect();
            keys.into_iter().find_map(|key| {
                let inner = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                let value = |map: &serde_json::Map<_, _>| map.get(key).cloned().unwrap_or(Value::Null);
                difference(&inner, &value(a), &value(b))
            })
        }
        (Value::String(text), _) if text.contains('\n') => Some(format!("`{path}` differs")),
        _ => Some(format!("{path}: found {found}, expected {expected}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_journal_continues_after_an_incomplete_line_and_refuses_other_work() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/journal.jsonl");
        let open = |seed: u32| {
            let header = serde_json::json!({ "seed": seed, "bench": "[shaft]\nmass_kg = 1" });
            Journal::open::<(u32, f64)>(&path, &header)
        };
        let (mut journal, results) = open(2).unwrap();
        assert_eq!(results, []);
        assert!(matches!(open(2), Err(JournalError::Locked { .. })));
        journal.append(&(7, f64::MAX)).unwrap();
        journal.file.write_all(b"[8,").unwrap();
        drop(journal);
        let (mut journal, results) = open(2).unwrap();
        assert_eq!(results, [(7, f64::MAX)]);
        journal.append(&(8, 0.5)).unwrap();
        drop(journal);
        assert_eq!(open(2).unwrap().1.len(), 2, "the incomplete line is gone");

        let refused = |seed| open(seed).unwrap_err().to_string();
        assert!(refused(3).contains("line 1: it belongs to other work: seed: found 2, expected 3"));
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, text.replace("mass_kg = 1", "mass_kg = 2")).unwrap();
        assert!(refused(2).contains("`bench` differs;"), "{}", refused(2));
        let header = text.lines().next().unwrap();
        std::fs::write(&path, format!("{header}\nno result\n")).unwrap();
        assert!(refused(2).contains("line 2: found no result"));
        std::fs::write(&path, "\n[7,0.5]\n").unwrap();
        assert!(refused(2).contains("line 2"), "the first line that is not empty is the header");
        std::fs::write(&path, "somebody's notes\n").unwrap();
        assert!(refused(2).contains("line 1: found no header"));
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "somebody's notes\n");
    }
}
