//! Running other programs. Every command line is printed; a failure names the command.

use std::ffi::OsStr;
use std::io::Read;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Reason why a command failed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ChoreError {
    /// A program could not be started.
    #[error("{program}: {source}")]
    NotStarted {
        /// The program.
        program: String,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// A program failed.
    #[error("`{line}` failed ({status})")]
    Failed {
        /// The command line.
        line: String,
        /// Exit status.
        status: String,
    },
    /// A step that the user has to do, or a sentence that explains the failure.
    #[error("{0}")]
    ByHand(String),
    /// A result differs from the expected one.
    #[error("{what}: found\n{found}\nexpected\n{expected}")]
    Differs {
        /// Quantity that was compared.
        what: String,
        /// Measured value.
        found: String,
        /// Expected value.
        expected: String,
    },
    /// A file does not hold what it should.
    #[error("{file}: {found}; expected {expected}", file = file.display())]
    File {
        /// Path of the file.
        file: PathBuf,
        /// Content or error that was found.
        found: String,
        /// Content that was expected.
        expected: &'static str,
    },
}

/// Returns the root folder of the workspace.
pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new("."))
}

/// Returns cargo's target folder.
pub(crate) fn target_folder() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from)
}

/// Returns a command for the calling cargo, or for the one on the path.
///
/// Its builds are not incremental unless the environment says so: the files for a next build would
/// take 4 GB, a third of what a run of all tests writes.
pub(crate) fn cargo() -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(root());
    if std::env::var_os("CARGO_INCREMENTAL").is_none() {
        command.env("CARGO_INCREMENTAL", "0");
    }
    command
}

/// Returns a command line for reports.
pub(crate) fn line(command: &Command) -> String {
    let program = Path::new(command.get_program()).file_name().unwrap_or(command.get_program());
    std::iter::once(program)
        .chain(command.get_args())
        .map(OsStr::to_string_lossy)
        .collect::<Vec<_>>()
        .join(" ")
}

/// Returns a conversion of the error with which a program did not start.
pub(crate) fn not_started(command: &Command) -> impl Fn(std::io::Error) -> ChoreError + use<> {
    let program = command.get_program().to_string_lossy().into_owned();
    move |source| ChoreError::NotStarted { program: program.clone(), source }
}

/// Runs a program and shows its output.
pub(crate) fn run(command: &mut Command) -> Result<(), ChoreError> {
    eprintln!("+ {}", line(command));
    let status = command.status().map_err(not_started(command))?;
    if status.success() {
        Ok(())
    } else {
        Err(ChoreError::Failed { line: line(command), status: status.to_string() })
    }
}

/// Starts a program with its output piped; returns it with its command line.
pub(crate) fn spawn_piped(command: &mut Command) -> Result<(Child, String), ChoreError> {
    let line = line(command);
    eprintln!("+ {line}");
    let child = command.stdout(Stdio::piped()).spawn().map_err(not_started(command))?;
    Ok((child, line))
}

/// End of a program that ran with a timeout.
pub(crate) struct Ended {
    /// Exit status.
    pub(crate) status: std::process::ExitStatus,
    /// False if it was killed at the timeout.
    pub(crate) is_in_time: bool,
    /// Output if it is piped.
    pub(crate) text: String,
}

/// Runs a program with a timeout, after which it is killed. Returns the program's output if it is
/// piped.
pub(crate) fn run_with_timeout(command: &mut Command, timeout: Duration) -> Result<String, ChoreError> {
    let Ended { status, is_in_time, text } = output_with_timeout(command, timeout)?;
    if status.success() {
        return Ok(text);
    }
    let late = if is_in_time { String::new() } else { format!(" after {} s", timeout.as_secs()) };
    let printed = if text.is_empty() { String::new() } else { format!("; it printed: {text}") };
    Err(ChoreError::Failed { line: line(command), status: format!("{status}{late}{printed}") })
}

/// Runs a program with a timeout, after which it is killed. A failure of the program is no error.
pub(crate) fn output_with_timeout(command: &mut Command, timeout: Duration) -> Result<Ended, ChoreError> {
    let line = line(command);
    let failed = |status: String| ChoreError::Failed { line: line.clone(), status };
    let cause = |error: std::io::Error| failed(error.to_string());
    // Its own group, so that the timeout ends the programs that it started, too.
    let mut child = command.process_group(0).spawn().map_err(not_started(command))?;
    // Read while the program runs: it would block on a full pipe.
    let output = child.stdout.take().map(|mut output| {
        std::thread::spawn(move || {
            let mut text = String::new();
            output.read_to_string(&mut text).map(|_| text)
        })
    });
    let start = Instant::now();
    let (status, is_in_time) = loop {
        match child.try_wait().map_err(cause)? {
            Some(status) => break (status, true),
            None if start.elapsed() > timeout => {
                // The kill fails if the program has just ended; that is fine.
                let _ = Command::new("kill").args(["-KILL", "--", &format!("-{}", child.id())]).status();
                break (child.wait().map_err(cause)?, false);
            }
            None => std::thread::sleep(Duration::from_millis(10)),
        }
    };
    let text = output.map_or(Ok(String::new()), |output| {
        output.join().unwrap_or_else(|_| Err(std::io::Error::other("its output could not be read")))
    });
    Ok(Ended { status, is_in_time, text: text.map_err(cause)? })
}

/// Writes a file atomically: under another name, then renamed.
pub(crate) fn write_atomically(file: PathBuf, content: impl AsRef<[u8]>) -> Result<(), ChoreError> {
    let temporary = file.with_extension("new");
    let written = std::fs::write(&temporary, content).and_then(|()| std::fs::rename(&temporary, &file));
    written.map_err(of_file(&file, "a file that can be written"))
}

/// Returns a conversion of the operating system's errors about a file or folder.
pub(crate) fn of_file(path: &Path, expected: &'static str) -> impl Fn(std::io::Error) -> ChoreError + use<> {
    let file = path.to_owned();
    move |error| ChoreError::File { file: file.clone(), found: error.to_string(), expected }
}

/// Copies a file and creates the folders of the copy.
pub(crate) fn copy(from: &Path, to: &Path) -> Result<(), ChoreError> {
    let folder = to.parent().map_or(Ok(()), std::fs::create_dir_all);
    folder
        .and_then(|()| std::fs::copy(from, to))
        .map(drop)
        .map_err(of_file(from, "a file that can be copied"))
}

/// Runs a program and returns its standard output.
pub(crate) fn output_of(command: &mut Command) -> Result<String, ChoreError> {
    let output = command.stderr(Stdio::inherit()).output().map_err(not_started(command))?;
    if output.status.success() {
        Ok(String::from_utf8_lossy(&output.stdout).into_owned())
    } else {
        Err(ChoreError::Failed { line: line(command), status: output.status.to_string() })
    }
}

/// Returns whether a program runs and succeeds; its output is not shown.
pub(crate) fn succeeds(command: &mut Command) -> bool {
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|s| s.success())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shell(script: &str, timeout: Duration) -> Result<String, ChoreError> {
        let mut command = Command::new("sh");
        run_with_timeout(command.args(["-c", script]).stdout(Stdio::piped()), timeout)
    }

    #[test]
    fn long_output_is_read_and_a_program_that_does_not_end_is_killed() {
        let long = Duration::from_secs(60);
        let text = shell(
            "i=0; while [ $i -lt 4000 ]; do echo 0123456789012345678901234567890123456789; i=$((i+1)); done",
            long,
        );
        assert_eq!(text.unwrap().len(), 4000 * 41);
        let start = Instant::now();
        let late = shell("exec sleep 60", Duration::from_millis(100)).unwrap_err().to_string();
        assert!(late.contains("after 0 s") && start.elapsed() < Duration::from_secs(30), "{late}");
        let start = Instant::now();
        let grandchild = shell("sleep 60 & wait", Duration::from_millis(100));
        assert!(grandchild.is_err() && start.elapsed() < Duration::from_secs(30));
        let failed = shell("echo cause; exit 3", long).unwrap_err().to_string();
        assert!(failed.contains("3") && failed.contains("it printed: cause"), "{failed}");
    }
}
