//! Origin of a result: program, command, inputs and day.
//!
//! The same command on the same inputs gives the same text all day, on any number of threads and in
//! any folder.

use model_quant::exchange::key::digits;
use report::page::Page;
use schemars::JsonSchema;
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::ffi::OsString;
use std::io::Read;
use std::path::Path;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// Options that do not change a result, each with a value.
const WITHOUT_EFFECT: [&str; 4] = ["--out", "-o", "--threads", "--record"];

/// Variable with the time of a reproducible build or report, in seconds since 1970.
const EPOCH: &str = "SOURCE_DATE_EPOCH";

/// Origin of a result.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub(crate) struct Provenance {
    /// Version of the program.
    pub(crate) version: String,
    /// Command line, without the output folder and the number of threads.
    pub(crate) command: String,
    /// Files that the command line names.
    pub(crate) inputs: Vec<Input>,
    /// Day of the result (UTC), as year-month-day.
    pub(crate) date: String,
}

/// Input file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub(crate) struct Input {
    /// Path, as it was typed.
    pub(crate) path: String,
    /// SHA-256 of the content, hexadecimal.
    pub(crate) sha256: String,
}

/// Result with its origin.
#[derive(Serialize, JsonSchema)]
pub(crate) struct Stamped<'a, T> {
    #[serde(flatten)]
    pub(crate) result: &'a T,
    /// Origin of the result.
    pub(crate) provenance: Provenance,
}

impl Provenance {
    /// Returns the origin of a result of this process.
    pub(crate) fn of_process() -> Self {
        let epoch = std::env::var(EPOCH).ok().and_then(|text| text.parse().ok()).map(Duration::from_secs);
        let now = epoch.unwrap_or_else(|| SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default());
        Self::new(std::env::args_os().skip(1), now)
    }

    fn new(arguments: impl Iterator<Item = OsString>, since_1970: Duration) -> Self {
        let kept = with_effect(arguments.map(|text| text.to_string_lossy().into_owned()));
        let words = ["host-sim"].into_iter().chain(kept.iter().map(String::as_str));
        let seconds = i64::try_from(since_1970.as_secs()).unwrap_or_default();
        let date = chrono::DateTime::from_timestamp(seconds, 0).unwrap_or_default();
        let values = kept.iter().map(|word| word.split_once('=').map_or(word.as_str(), |(_, value)| value));
        Self {
            version: env!("CARGO_PKG_VERSION").into(),
            command: shlex::try_join(words).unwrap_or_default(),
            inputs: values.filter_map(Input::read).collect(),
            date: date.format("%Y-%m-%d").to_string(),
        }
    }

    /// Appends the origin to the end of a page.
    pub(crate) fn add_to(&self, page: &mut Page) {
        page.section("Origin");
        page.text(&format!("host-sim {}, {} (UTC): {}", self.version, self.date, self.command));
        if !self.inputs.is_empty() {
            let rows: Vec<[&str; 2]> = self.inputs.iter().map(|i| [i.path.as_str(), &i.sha256]).collect();
            let rows: Vec<Vec<&str>> = rows.into_iter().map(Vec::from).collect();
            page.table(&["input", "SHA-256"], &rows);
        }
    }
}

/// Returns the arguments without the options that do not change a result.
fn with_effect(mut arguments: impl Iterator<Item = String>) -> Vec<String> {
    let mut kept = Vec::new();
    while let Some(word) = arguments.next() {
        if WITHOUT_EFFECT.contains(&word.as_str()) {
            arguments.next();
        } else if !WITHOUT_EFFECT.iter().any(|o| word.strip_prefix(o).is_some_and(|v| v.starts_with('='))) {
            kept.push(word);
        }
    }
    kept
}

impl Input {
    /// Reads a file; `None` if there is none with this path.
    fn read(path: &str) -> Option<Self> {
        if !Path::new(path).is_file() {
            return None;
        }
        let mut file = std::fs::File::open(path).ok()?;
        let (mut hash, mut block) = (Sha256::new(), vec![0; 1 << 16]);
        loop {
            match file.read(&mut block).ok()? {
                0 => break,
                length => hash.update(block.get(..length)?),
            }
        }
        Some(Self { path: path.into(), sha256: digits(&hash.finalize()) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn provenance(words: &[&str]) -> Provenance {
        Provenance::new(words.iter().map(OsString::from), Duration::from_secs(1_795_677_273))
    }

    #[test]
    fn the_folder_and_the_threads_are_no_part_of_the_origin() {
        let plain = provenance(&["sweep", "clearance", "--seed", "2"]);
        assert_eq!(plain.command, "host-sim sweep clearance --seed 2");
        assert_eq!(plain.date, "2026-11-26");
        assert_eq!(provenance(&["sweep", "clearance", "--threads=2", "--seed", "2", "--out", "x"]), plain);
        assert_eq!(provenance(&["sweep", "--out=x", "clearance", "--threads", "7", "--seed", "2"]), plain);
        assert_ne!(provenance(&["sweep", "clearance", "--seed", "3"]), plain);
    }

    #[test]
    fn named_files_have_their_hash() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a log.csv");
        std::fs::write(&path, "abc").unwrap();
        let path = path.to_str().unwrap();
        let found = provenance(&["check", path, &format!("--bench={path}"), "absent.csv"]);
        assert_eq!(found.inputs.len(), 2);
        let sha256 = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert!(found.inputs.iter().all(|input| input.path == path && input.sha256 == sha256));
        assert!(found.command.contains("a log.csv'"), "{}", found.command);
    }

    #[test]
    fn a_stamped_result_keeps_its_fields_in_order() {
        #[derive(Serialize)]
        struct Result {
            b: f32,
            a: Option<u8>,
        }
        let stamped = Stamped { result: &Result { b: 0.1, a: None }, provenance: provenance(&["run"]) };
        let text = serde_json::to_string(&stamped).unwrap();
        assert!(text.starts_with(r#"{"b":0.1,"a":null,"provenance":{"version":"#), "{text}");
    }
}
