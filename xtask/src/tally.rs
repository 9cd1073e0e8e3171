//! Results of `cargo test`, read from its output while the output is shown.

use crate::run::{ChoreError, spawn_piped};
use std::io::{BufRead, BufReader, Write};
use std::process::Command;

/// Counts of `cargo test` over all test programs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Tally {
    /// Tests that passed.
    pub(crate) passed: u64,
    /// Tests that failed.
    pub(crate) failed: u64,
    /// Names of the ignored tests with the reasons that the code states.
    pub(crate) ignored: Vec<String>,
    /// Command lines that failed.
    pub(crate) failed_commands: Vec<String>,
}

impl Tally {
    /// Runs a test command, shows its output and adds its results. A failure is counted, not
    /// returned.
    pub(crate) fn run(&mut self, command: &mut Command) -> Result<(), ChoreError> {
        let (mut child, line) = spawn_piped(command)?;
        let failed =
            |error: std::io::Error| ChoreError::Failed { line: line.clone(), status: error.to_string() };
        if let Some(output) = child.stdout.take() {
            let mut shown = std::io::stdout().lock();
            for text in BufReader::new(output).lines() {
                let text = text.map_err(failed)?;
                writeln!(shown, "{text}").map_err(failed)?;
                self.read(&text);
            }
        }
        if !child.wait().map_err(failed)?.success() {
            self.failed_commands.push(line);
        }
        Ok(())
    }

    /// Reads a line of a test program.
    pub(crate) fn read(&mut self, line: &str) {
        if let Some((name, reason)) =
            line.strip_prefix("test ").and_then(|line| line.split_once(" ... ignored"))
        {
            self.ignored.push(format!("{name}{reason}"));
        }
        let Some(counts) = line.strip_prefix("test result: ") else { return };
        let count = |word: &str| {
            let (before, _) = counts.split_once(word)?;
            before.rsplit([' ', '.', ';']).find(|part| !part.is_empty())?.parse::<u64>().ok()
        };
        self.passed += count(" passed").unwrap_or(0);
        self.failed += count(" failed").unwrap_or(0);
    }

    /// Returns the totals in the format of a test program's last line.
    pub(crate) fn summary(&self, seconds: f64) -> String {
        let verdict = if self.failed_commands.is_empty() { "ok" } else { "FAILED" };
        format!(
            "test result: {verdict}. {} passed; {} failed; {} ignored; 0 measured; 0 filtered out; \
             finished in {seconds:.2}s",
            self.passed,
            self.failed,
            self.ignored.len()
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_summed_and_ignored_tests_are_named_with_their_reasons() {
        let mut tally = Tally::default();
        for line in [
            "test a ... ok",
            "test b::c ... ignored, slow",
            "test result: ok. 12 passed; 0 failed; 1 ignored; 0 measured; finished in 0.1s",
            "test result: FAILED. 3 passed; 2 failed; 0 ignored; 0 measured; finished in 1s",
        ] {
            tally.read(line);
        }
        assert_eq!((tally.passed, tally.failed), (15, 2));
        assert_eq!(tally.ignored, ["b::c, slow"]);
        tally.failed_commands.push("cargo test".into());
        assert_eq!(
            tally.summary(1.5),
            "test result: FAILED. 15 passed; 2 failed; 1 ignored; 0 measured; 0 filtered out; \
             finished in 1.50s"
        );
    }
}
