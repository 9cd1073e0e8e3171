//! Test programs of the workspace, run several at a time.
//!
//! Cargo runs them one after the other, and many of them wait, or end with one long test. Their
//! outputs are shown whole, each when its program has ended.

use crate::run::{ChoreError, line, not_started, output_of};
use crate::tally::Tally;
use crate::workspace;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Last words of the jobs that take the longest; they start first, so that none of them is left
/// alone at the end.
const LONGEST: [&str; 7] =
    ["hidden_effects_matrix", "hidden_effects", "emulator", "parts", "catalogue", DOCUMENTATION, "mechanism"];
/// Argument of cargo for the tests in documentation comments.
const DOCUMENTATION: &str = "--doc";

/// Message of cargo about a file that it has built.
#[derive(Deserialize)]
struct Message {
    executable: Option<PathBuf>,
    manifest_path: Option<PathBuf>,
    profile: Option<Profile>,
    target: Option<Target>,
}

#[derive(Deserialize)]
struct Profile {
    test: bool,
}

#[derive(Deserialize)]
struct Target {
    name: String,
}

/// A test program and what a report calls it.
struct Job {
    name: String,
    command: Command,
}

impl Job {
    /// The test program of a line of cargo's messages; none if the line has none.
    fn read(message: &str, arguments: &[&str]) -> Option<Self> {
        let message: Message = serde_json::from_str(message).ok()?;
        let executable = message.executable.filter(|_| message.profile.is_some_and(|p| p.test))?;
        let folder = message.manifest_path?.parent().map(Path::to_owned)?;
        let package = folder.file_name()?.to_string_lossy().into_owned();
        let mut command = Command::new(executable);
        command.args(arguments).current_dir(&folder).env("CARGO_MANIFEST_DIR", &folder);
        Some(Self { name: format!("{package} {}", message.target?.name), command })
    }

    /// The tests in documentation comments, which cargo compiles and runs.
    fn documentation() -> Self {
        let mut command = workspace::tests();
        command.args(["--no-fail-fast", DOCUMENTATION]);
        Self { name: line(&command), command }
    }

    /// Position in the queue.
    fn rank(&self) -> usize {
        let is_own = |name: &&str| self.name.rsplit(' ').next() == Some(*name);
        LONGEST.iter().position(is_own).unwrap_or(LONGEST.len())
    }

    /// Runs the program; shows its output and adds its results to a tally.
    fn run(mut self, tally: &Mutex<&mut Tally>) -> Result<(), ChoreError> {
        eprintln!("started {}", self.name);
        let start = Instant::now();
        let output = self.command.output().map_err(not_started(&self.command))?;
        let [stdout, stderr] = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
        let mut tally = tally.lock().unwrap_or_else(PoisonError::into_inner);
        print!("\n{} ({:.1} s)\n{stdout}{stderr}", self.name, start.elapsed().as_secs_f64());
        stdout.lines().for_each(|line| tally.read(line));
        if !output.status.success() {
            tally.failed_commands.push(self.name);
        }
        Ok(())
    }
}

/// Kind of tests to run.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Choice<'a> {
    /// Those that are not ignored, the ones in documentation comments included.
    Usual,
    /// Ignored ones, but for those whose names contain a text.
    IgnoredBut(&'a str),
}

/// Builds and runs the test programs of the workspace, as many at a time as the machine has cores,
/// with variables of the environment. A failed test is counted, not returned.
pub(crate) fn run_all(
    choice: Choice<'_>,
    variables: &[(&str, &str)],
    tally: &mut Tally,
) -> Result<(), ChoreError> {
    let arguments = match choice {
        Choice::Usual => vec![],
        Choice::IgnoredBut(name) => vec!["--ignored", "--skip", name],
    };
    let built =
        output_of(workspace::tests().args(["--no-run", "--message-format", "json-render-diagnostics"]))?;
    let mut jobs: Vec<Job> = built.lines().filter_map(|line| Job::read(line, &arguments)).collect();
    if jobs.is_empty() {
        return Err(ChoreError::ByHand("cargo named no test program in its messages".into()));
    }
    if choice == Choice::Usual {
        jobs.push(Job::documentation());
    }
    jobs.sort_by_key(Job::rank);
    for job in &mut jobs {
        job.command.envs(variables.iter().copied());
    }
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let (queue, tally) = (Mutex::new(jobs.into_iter()), Mutex::new(tally));
    let work = || -> Result<(), ChoreError> {
        loop {
            let next = queue.lock().unwrap_or_else(PoisonError::into_inner).next();
            let Some(job) = next else { return Ok(()) };
            job.run(&tally)?;
        }
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..cores).map(|_| scope.spawn(work)).collect();
        workers.into_iter().try_for_each(|worker| {
            worker.join().unwrap_or_else(|_| Err(ChoreError::ByHand("a thread of the tests panicked".into())))
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shell(script: &str) -> Job {
        let mut command = Command::new("sh");
        command.args(["-c", script]);
        Job { name: "workspace emulator".into(), command }
    }

    #[test]
    fn only_test_programs_are_read_from_the_messages_of_cargo() {
        let message = |test: bool, executable: &str| {
            format!(
                r#"{{"reason":"compiler-artifact","manifest_path":"/w/crates/bench/Cargo.toml",
                "target":{{"name":"laws"}},"profile":{{"test":{test}}},"executable":{executable}}}"#
            )
            .replace('\n', "")
        };
        let job = Job::read(&message(true, r#""/t/laws-1""#), &["--ignored"]).unwrap();
        assert_eq!((job.name.as_str(), job.rank()), ("bench laws", LONGEST.len()));
        assert_eq!(job.command.get_current_dir(), Some(Path::new("/w/crates/bench")));
        assert_eq!(job.command.get_args().collect::<Vec<_>>(), ["--ignored"]);
        for other in [message(false, r#""/t/host-sim""#), message(true, "null"), "no message".into()] {
            assert!(Job::read(&other, &[]).is_none(), "{other}");
        }
    }

    #[test]
    fn the_longest_jobs_come_first_whatever_their_package() {
        let ranks = [shell("").rank(), Job::documentation().rank()];
        assert_eq!(ranks, [2, 5]);
    }

    #[test]
    fn a_program_that_fails_is_counted_and_named() {
        let mut tally = Tally::default();
        let shared = Mutex::new(&mut tally);
        shell("echo 'test result: ok. 2 passed; 0 failed; 0 ignored'").run(&shared).unwrap();
        shell("echo 'test result: FAILED. 1 passed; 1 failed; 0 ignored'; exit 101").run(&shared).unwrap();
        shell("kill -9 $$").run(&shared).unwrap();
        assert_eq!((tally.passed, tally.failed, tally.failed_commands.len()), (3, 1, 2));
    }
}
