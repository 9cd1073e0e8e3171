//! The journal of a sweep: a header that says which sweep, then one line of JSON a finished run, in any order.
//!
//! A line is written in one go and counts once its newline is there, so a kill costs at most the runs that were under
//! way; half a line at the end is cut off on the next start. Two sweeps cannot write the same journal at once. A power
//! cut may cost lines that the system had not yet written, never more than runs.

use super::specification::Specification;
use crate::error::CliError;
use crate::summary::Figures;
use rustix::fs::{FlockOperation, flock};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::Path;

/// Name in the output folder.
pub const NAME: &str = "journal.jsonl";

/// What a journal belongs to. Any difference and the runs are not the same.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// Version of the program.
    pub version: String,
    /// The sweep.
    pub specification: Specification,
    /// The base bench's description.
    pub bench: String,
    /// Check sums of the networks, by bearing; empty for the analytic law.
    pub networks: BTreeMap<String, String>,
    /// Communication step of the networks, s.
    pub step_s: f64,
}

/// One finished run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Number of the point.
    pub index: usize,
    /// What came out, or why nothing did.
    pub outcome: Result<Figures, String>,
    /// Wall time in s.
    pub wall_s: f64,
}

/// An open journal.
#[derive(Debug)]
pub struct Journal {
    file: File,
    name: String,
}

impl Journal {
    /// Opens the journal of a sweep in a folder, new or begun before; gives the finished runs.
    pub fn open(
        folder: &Path,
        header: &Header,
        runs: usize,
    ) -> Result<(Self, BTreeMap<usize, Record>), CliError> {
        let path = folder.join(NAME);
        let name = path.display().to_string();
        let failed = |e: std::io::Error| CliError::Work(format!("{name}: {e}"));
        std::fs::create_dir_all(folder).map_err(failed)?;
        let mut file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(&path)
            .map_err(failed)?;
        flock(&file, FlockOperation::NonBlockingLockExclusive)
            .map_err(|e| CliError::Work(format!("{name}: another sweep is writing it ({e})")))?;
        let mut text = Vec::new();
        file.read_to_end(&mut text).map_err(failed)?;
        let whole = text.iter().rposition(|b| *b == b'\n').map_or(0, |at| at + 1);
        let finished = read(&name, text.get(..whole).unwrap_or_default(), header, runs)?;
        file.set_len(whole as u64).map_err(failed)?;
        file.seek(SeekFrom::End(0)).map_err(failed)?;
        let mut journal = Self { file, name };
        if whole == 0 {
            journal.line(header)?;
        }
        Ok((journal, finished))
    }

    /// Adds a finished run.
    pub fn add(&mut self, record: &Record) -> Result<(), CliError> {
        self.line(record)
    }

    fn line(&mut self, value: &impl Serialize) -> Result<(), CliError> {
        let failed =
            |e: &dyn std::fmt::Display| CliError::Work(format!("{}: cannot be written: {e}", self.name));
        let mut line = serde_json::to_vec(value).map_err(|e| failed(&e))?;
        line.push(b'\n');
        self.file.write_all(&line).map_err(|e| failed(&e))
    }
}

fn read(name: &str, text: &[u8], header: &Header, runs: usize) -> Result<BTreeMap<usize, Record>, CliError> {
    let mut lines = text.split(|b| *b == b'\n').filter(|line| !line.is_empty());
    let Some(first) = lines.next() else { return Ok(BTreeMap::new()) };
    let damaged = |line: usize, found: String| {
        CliError::Input(format!("{name}, line {line}: {found}; remove the journal or choose another --out"))
    };
    let found: serde_json::Value =
        serde_json::from_slice(first).map_err(|e| damaged(1, format!("found no header of a sweep ({e})")))?;
    let expected = serde_json::to_value(header).map_err(|e| CliError::Work(format!("{name}: {e}")))?;
    if let Some(difference) = difference("", &found, &expected) {
        return Err(damaged(1, format!("it belongs to another sweep: {difference}")));
    }
    let mut finished = BTreeMap::new();
    for (i, line) in lines.enumerate() {
        let record: Record = serde_json::from_slice(line)
            .map_err(|e| damaged(i + 2, format!("found no record of a run ({e})")))?;
        if record.index >= runs {
            return Err(damaged(i + 2, format!("found run {}; expected 0 to {}", record.index, runs - 1)));
        }
        finished.insert(record.index, record);
    }
    Ok(finished)
}

/// The first field in which two headers differ, in words.
fn difference(path: &str, found: &serde_json::Value, expected: &serde_json::Value) -> Option<String> {
    use serde_json::Value::Object;
    if found == expected {
        return None;
    }
    if let (Object(a), Object(b)) = (found, expected) {
        let null = serde_json::Value::Null;
        let keys: std::collections::BTreeSet<&String> = a.keys().chain(b.keys()).collect();
        return keys.into_iter().find_map(|key| {
            let inner = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
            difference(&inner, a.get(key).unwrap_or(&null), b.get(key).unwrap_or(&null))
        });
    }
    if path == "bench" {
        return Some("the base bench's description differs".into());
    }
    Some(format!("{path}: found {found}, expected {expected}"))
}
