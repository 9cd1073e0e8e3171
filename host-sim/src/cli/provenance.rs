//! Origin of a result: program, command, inputs and day.
//!
//! The same command on the same inputs gives the same text all day, on any number of threads and in
//! any folder.

use super::error::CliError;
use chrono::{DateTime, Utc};
use model_quant::exchange::key::digits;
use report::page::Page;
use schemars::JsonSchema;
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::ffi::OsString;
use std::io::Read;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// Options that do not change a result, each with a value. A token must not be in a result.
const WITHOUT_EFFECT: [&str; 9] = [
    "--out",
    "-o",
    "--threads",
    "--record",
    "--color",
    "--watch-speed",
    "--serve-token",
    "--serve-for",
    "--link-key",
];

/// Options without a value that do not change a result.
const OF_THE_TERMINAL: [&str; 6] = ["--json", "-q", "--quiet", "-v", "--verbose", "--watch"];

/// Option that does not change a result, with a value or without one.
const SERVE: &str = "--serve";

/// Results in the folder of a run.
const RESULTS: [&str; 2] = ["run.json", "log.csv"];

/// Start of the current command.
static START: Mutex<Option<Start>> = Mutex::new(None);

/// Variable with the time of a reproducible report, in seconds since 1970.
const EPOCH: &str = "SOURCE_DATE_EPOCH";

/// Origin of a result.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub(crate) struct Provenance {
    /// Version of the program.
    pub(crate) version: String,
    /// Command line, without the output folder and the number of threads.
    pub(crate) command: String,
    /// Files that the command line names, and the results in the folders of runs that it names.
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

/// Arguments and time of a command.
#[derive(Clone)]
struct Start {
    arguments: Vec<OsString>,
    time: DateTime<Utc>,
}

/// Notes the arguments of a command, of which the first is the program, and its time: that of
/// `SOURCE_DATE_EPOCH`, or now without it.
///
/// # Errors
///
/// The variable is not a number of seconds after 1970.
pub(crate) fn note_start(arguments: Vec<OsString>) -> Result<(), CliError> {
    let time = match std::env::var_os(EPOCH) {
        None => Utc::now(),
        Some(text) => {
            let seconds = text.to_str().and_then(|text| text.parse().ok()).filter(|seconds| *seconds >= 0);
            seconds.and_then(|seconds| DateTime::from_timestamp(seconds, 0)).ok_or_else(|| {
                CliError::Input(format!("{EPOCH}: found {text:?}; expected a number of seconds after 1970"))
            })?
        }
    };
    *START.lock().unwrap_or_else(PoisonError::into_inner) = Some(Start { arguments, time });
    Ok(())
}

impl Provenance {
    /// Returns the origin of a result of the current command, or else of this process.
    pub(crate) fn of_process() -> Self {
        let noted = START.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let of_process = || Start { arguments: std::env::args_os().collect(), time: Utc::now() };
        let Start { arguments, time } = noted.unwrap_or_else(of_process);
        Self::new(arguments.into_iter().skip(1), time)
    }

    fn new(arguments: impl Iterator<Item = OsString>, now: DateTime<Utc>) -> Self {
        let effective = with_effect(arguments.map(|text| text.to_string_lossy().into_owned()));
        let words = ["host-sim"].into_iter().chain(effective.iter().map(String::as_str));
        // The first word is the command.
        let values = effective
            .iter()
            .skip(1)
            .map(|word| word.split_once('=').map_or(word.as_str(), |(_, value)| value));
        Self {
            version: env!("CARGO_PKG_VERSION").into(),
            command: shlex::try_join(words).unwrap_or_default(),
            inputs: values.flat_map(files).filter_map(|path| Input::read(&path)).collect(),
            date: now.format("%Y-%m-%d").to_string(),
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

/// Returns the path of a file, or of the results in the folder of a run.
fn files(path: &str) -> Vec<String> {
    if !Path::new(path).join(RESULTS[0]).is_file() {
        return vec![path.into()];
    }
    RESULTS.iter().map(|name| format!("{}/{name}", path.trim_end_matches('/'))).collect()
}

/// Returns the arguments without the options that do not change a result.
fn with_effect(arguments: impl Iterator<Item = String>) -> Vec<String> {
    let mut arguments = arguments.peekable();
    let mut effective = Vec::new();
    while let Some(word) = arguments.next() {
        let is_joined = |o: &str| word.strip_prefix(o).is_some_and(|value| value.starts_with('='));
        if WITHOUT_EFFECT.contains(&word.as_str()) {
            arguments.next();
        } else if word == SERVE {
            arguments.next_if(|value| !value.starts_with('-'));
        } else if !OF_THE_TERMINAL.contains(&word.as_str())
            && !WITHOUT_EFFECT.iter().any(|o| is_joined(o))
            && !is_joined(SERVE)
        {
            effective.push(word);
        }
    }
    effective
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
        let now = DateTime::from_timestamp(1_795_677_273, 0).unwrap();
        Provenance::new(words.iter().map(OsString::from), now)
    }

    #[test]
    fn the_folder_and_the_threads_are_no_part_of_the_origin() {
        let plain = provenance(&["sweep", "clearance", "--seed", "2"]);
        assert_eq!(plain.command, "host-sim sweep clearance --seed 2");
        assert_eq!(plain.date, "2026-11-26");
        assert_eq!(provenance(&["sweep", "clearance", "--threads=2", "--seed", "2", "--out", "x"]), plain);
        assert_eq!(provenance(&["sweep", "--out=x", "clearance", "--threads", "7", "--seed", "2"]), plain);
        assert_eq!(
            provenance(&["sweep", "clearance", "--json", "--seed", "2", "-q", "--color", "never"]),
            plain
        );
        assert_ne!(provenance(&["sweep", "clearance", "--seed", "3"]), plain);
    }

    #[test]
    fn a_live_view_and_its_token_are_no_part_of_the_origin() {
        let plain = provenance(&["run", "--seed", "2"]);
        for words in [
            &["run", "--serve", "--seed", "2"][..],
            &["run", "--serve", "127.0.0.1:0", "--serve-token", "secret", "--seed", "2", "--serve-for", "1"],
            &["run", "--serve=0", "--serve-token=secret", "--serve-for=1", "--seed", "2", "--serve"],
            &["run", "--watch", "--watch-speed", "0.5", "--seed", "2"],
        ] {
            assert_eq!(provenance(words), plain, "{words:?}");
        }
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
