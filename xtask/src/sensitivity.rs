//! Sensitivity of the diagnosis to its tuned constants.
//!
//! Each number in a `tuning.rs` is halved and doubled in a copy of the tree. The tests that then
//! fail are recorded: they hold the constant in place from that side. A constant that none holds is
//! not critical in the logs of these tests, which does not show that it is right in others.

use crate::document::Block;
use crate::run::{ChoreError, cargo, output_with_timeout, root, run, target_folder, write_atomically};
use regex_lite::Regex;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

/// Folder of the modules with constants.
const SOURCE: &str = "crates/diagnosis/src";
/// Modules with a `tuning.rs`.
pub(crate) const MODULES: [&str; 6] = ["check", "data", "experiment", "fit", "search", "verdict"];
/// File with the results.
const RECORD: &str = "tests/golden/tuning.json";
/// Place of the table.
const TABLE: Block = Block { file: "docs/tuning.md", name: "tuning" };
/// Tests that run with each value.
const TESTS: [&str; 7] = ["--lib", "--test", "results", "--test", "standstill", "--test", "checked_logs"];
/// Timeout of one build and its tests.
const TIMEOUT: Duration = Duration::from_secs(1200);
/// Name in place of tests if the code does not build.
const BUILD: &str = "the build";
/// Name in place of tests if they do not end in time.
const LATE: &str = "no end within 20 minutes";

/// Tests that fail with another value of a constant.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Failures {
    /// Value in the source.
    value: String,
    /// Those with half the value.
    half: Vec<String>,
    /// Those with twice the value.
    double: Vec<String>,
}

/// Results by module and constant.
type Record = BTreeMap<String, BTreeMap<String, Failures>>;

/// Measures the constants of some modules that the record does not hold with their present value.
/// Writes record and table after each one, so a stopped run continues.
pub(crate) fn sensitivity(modules: &[String]) -> Result<(), ChoreError> {
    let tree = copy()?;
    let mut record = read()?;
    let unchanged = failing(&tree)?;
    if !unchanged.is_empty() {
        return Err(ChoreError::ByHand(format!("these tests fail without a change: {unchanged:?}")));
    }
    for module in modules {
        let file = tree.join(SOURCE).join(module).join("tuning.rs");
        let text = text_of(&file)?;
        let known = record.entry(module.clone()).or_default();
        known.retain(|name, _| constants(&text).iter().any(|(constant, _)| constant == name));
        for (name, value) in constants(&text) {
            let known = record.entry(module.clone()).or_default();
            if known.get(&name).is_some_and(|known| known.value == value) {
                continue;
            }
            let [half, double] = [0.5, 2.0].map(|factor| {
                write_atomically(file.clone(), changed(&text, &name, &value, factor))?;
                let found = failing(&tree);
                write_atomically(file.clone(), &text)?;
                found
            });
            let failures = Failures { value, half: half?, double: double? };
            let [half, double] = [&failures.half, &failures.double].map(|tests| words(tests));
            eprintln!("{module}::{name} = {}: half {half}, double {double}", failures.value);
            known.insert(name, failures);
            write(&record)?;
        }
    }
    write(&record)
}

/// Clones the committed state, so that the tree can be edited meanwhile.
fn copy() -> Result<PathBuf, ChoreError> {
    let tree = target_folder().join("sensitivity/tree");
    let _ = std::fs::remove_dir_all(&tree);
    run(Command::new("git").args(["clone", "--quiet", "--shared"]).arg(root()).arg(&tree))?;
    Ok(tree)
}

/// Returns the names and values of the constants that are one number.
fn constants(text: &str) -> Vec<(String, String)> {
    let pattern = r"(?m)^pub\(crate\) const (\w+): \w+ =\s+([0-9][0-9_.e-]*);";
    let Ok(pattern) = Regex::new(pattern) else { return vec![] };
    let found = pattern.captures_iter(text).filter_map(|found| {
        let [name, value] = [1, 2].map(|group| found.get(group).map(|part| part.as_str().to_owned()));
        name.zip(value)
    });
    found.collect()
}

/// Returns the text with a constant multiplied by a factor. An integer stays one.
fn changed(text: &str, name: &str, value: &str, factor: f64) -> String {
    let number = value.replace('_', "").parse::<f64>().unwrap_or(f64::NAN) * factor;
    let is_integer = !value.contains(['.', 'e']);
    let other = if is_integer { format!("{}", number.floor()) } else { format!("{number:?}") };
    let lines = text.split_inclusive('\n').map(|line| {
        let is_named = line.starts_with(&format!("pub(crate) const {name}: "));
        if is_named { line.replace(&format!("= {value};"), &format!("= {other};")) } else { line.to_owned() }
    });
    lines.collect()
}

/// Returns the names of the tests that fail in the copy.
fn failing(tree: &Path) -> Result<Vec<String>, ChoreError> {
    let mut tests = cargo();
    tests.current_dir(tree).args(["test", "--package", "diagnosis", "--no-fail-fast"]).args(TESTS);
    tests.env("CARGO_TARGET_DIR", target_folder().join("sensitivity")).env("CARGO_INCREMENTAL", "1");
    let ended = output_with_timeout(tests.stdout(Stdio::piped()), TIMEOUT)?;
    if !ended.is_in_time {
        return Ok(vec![LATE.into()]);
    }
    let failed =
        ended.text.lines().filter_map(|line| line.strip_prefix("test ")?.strip_suffix(" ... FAILED"));
    let mut failed: Vec<String> = failed.map(str::to_owned).collect();
    if failed.is_empty() && !ended.status.success() {
        failed.push(BUILD.into());
    }
    failed.sort();
    Ok(failed)
}

fn text_of(file: &Path) -> Result<String, ChoreError> {
    std::fs::read_to_string(file).map_err(|error| ChoreError::File {
        file: file.into(),
        found: error.to_string(),
        expected: "a file that can be read",
    })
}

fn read() -> Result<Record, ChoreError> {
    let file = root().join(RECORD);
    serde_json::from_str(&text_of(&file)?).map_err(|error| ChoreError::File {
        file,
        found: error.to_string(),
        expected: "results as `cargo xtask sensitivity` writes them",
    })
}

/// Writes the table of the recorded results.
pub(crate) fn bless() -> Result<(), ChoreError> {
    TABLE.write(&table(&read()?)?)
}

/// Writes the record and the table.
fn write(record: &Record) -> Result<(), ChoreError> {
    write_atomically(root().join(RECORD), serde_json::to_string_pretty(record).unwrap_or_default() + "\n")?;
    TABLE.write(&table(record)?)
}

fn table(record: &Record) -> Result<String, ChoreError> {
    let texts: Result<Vec<String>, ChoreError> =
        MODULES.iter().map(|module| text_of(&source(module))).collect();
    let all = texts?.iter().map(|text| constants(text).len()).sum::<usize>();
    let measured = record.values().map(BTreeMap::len).sum::<usize>();
    let mut text = format!("{measured} of {all} constants are measured.\n\n");
    text.push_str("| constant | value | half | double |\n|---|---|---|---|\n");
    for (module, constants) in record {
        for (name, Failures { value, half, double }) in constants {
            // Writing to a string does not fail.
            let _ = writeln!(text, "| `{module}::{name}` | {value} | {} | {} |", words(half), words(double));
        }
    }
    Ok(text)
}

/// Returns the file with the constants of a module.
fn source(module: &str) -> PathBuf {
    root().join(SOURCE).join(module).join("tuning.rs")
}

/// Returns the first of the failing tests and the number of the others.
fn words(failures: &[String]) -> String {
    match failures {
        [] => "passes".into(),
        [one] if one == BUILD || one == LATE => format!("fails: {one}"),
        [one] => format!("fails `{one}`"),
        [first, others @ ..] => format!("fails `{first}` and {} more", others.len()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_found_and_changed_and_everything_else_stays() {
        let text = "/// X.\npub(crate) const A: f64 = 1e-9;\npub(crate) const AB: usize = 1_001;\n\
                    pub(crate) const C: f64 = 0.5 * A;\npub(crate) const D: [f64; 1] = [0.3];\n";
        let expected = [("A", "1e-9"), ("AB", "1_001")].map(|(a, b)| (a.to_owned(), b.to_owned()));
        assert_eq!(constants(text), expected);
        assert_eq!(changed(text, "A", "1e-9", 2.0), text.replace("1e-9", "2e-9"));
        assert_eq!(changed(text, "AB", "1_001", 0.5), text.replace("1_001", "500"));
    }

    #[test]
    fn recorded_values_are_those_of_the_source_and_the_table_is_that_of_the_record() {
        let record = read().unwrap();
        for (module, results) in &record {
            let text = text_of(&source(module)).unwrap();
            let constants: BTreeMap<_, _> = constants(&text).into_iter().collect();
            for (name, failures) in results {
                assert_eq!(constants.get(name), Some(&failures.value), "{module}::{name}: measure again");
            }
        }
        TABLE.check(&table(&record).unwrap()).unwrap();
    }
}
