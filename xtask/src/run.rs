//! Running other programs: what is run is shown, a failure says what failed.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Why a chore failed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ChoreError {
    /// A program could not be started.
    #[error("{program}: {source}")]
    NotStarted {
        /// The program.
        program: String,
        /// Cause.
        source: std::io::Error,
    },
    /// A program failed.
    #[error("`{line}` failed ({status})")]
    Failed {
        /// The command line.
        line: String,
        /// How it ended.
        status: String,
    },
    /// Something has to be done by hand.
    #[error("{0}")]
    ByHand(String),
    /// Something came out differently.
    #[error("{what}: found\n{found}\nexpected\n{expected}")]
    Differs {
        /// What was compared.
        what: String,
        /// What was found.
        found: String,
        /// What was expected.
        expected: String,
    },
    /// A file is not what it should be.
    #[error("{file}: {found}; expected {expected}", file = file.display())]
    File {
        /// The file.
        file: PathBuf,
        /// What was found.
        found: String,
        /// What was expected.
        expected: &'static str,
    },
}

/// The workspace's root.
pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new("."))
}

/// Cargo's target folder.
pub(crate) fn target_folder() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from)
}

/// The cargo that called, or the one on the path.
pub(crate) fn cargo() -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(root());
    command
}

fn line(command: &Command) -> String {
    let program = Path::new(command.get_program()).file_name().unwrap_or(command.get_program());
    std::iter::once(program)
        .chain(command.get_args())
        .map(OsStr::to_string_lossy)
        .collect::<Vec<_>>()
        .join(" ")
}

fn not_started(command: &Command) -> impl Fn(std::io::Error) -> ChoreError {
    let program = command.get_program().to_string_lossy().into_owned();
    move |source| ChoreError::NotStarted { program: program.clone(), source }
}

/// Runs a program with its output shown.
pub(crate) fn run(command: &mut Command) -> Result<(), ChoreError> {
    eprintln!("+ {}", line(command));
    let status = command.status().map_err(not_started(command))?;
    if status.success() {
        Ok(())
    } else {
        Err(ChoreError::Failed { line: line(command), status: status.to_string() })
    }
}

/// Runs a program and takes its standard output.
pub(crate) fn output_of(command: &mut Command) -> Result<String, ChoreError> {
    let output = command.stderr(Stdio::inherit()).output().map_err(not_started(command))?;
    if output.status.success() {
        Ok(String::from_utf8_lossy(&output.stdout).into_owned())
    } else {
        Err(ChoreError::Failed { line: line(command), status: output.status.to_string() })
    }
}

/// Whether a program runs and succeeds; its output is not shown.
pub(crate) fn succeeds(command: &mut Command) -> bool {
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|s| s.success())
}
