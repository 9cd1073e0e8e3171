//! The long campaigns on the emulated controller: `faults` and `soak`, programs of the package `system-tests`.
//!
//! Here the image is built; the arguments are the program's own, and so is the exit code.

use crate::run::{ChoreError, cargo};
use crate::{firmware, setup};
use std::ffi::OsString;
use std::process::ExitCode;

/// Builds the image and the program and runs it.
pub(crate) fn campaign(program: &'static str, arguments: &[OsString]) -> Result<ExitCode, ChoreError> {
    // Help needs no image.
    if !arguments.iter().any(|argument| argument == "--help" || argument == "-h") {
        setup::setup()?;
        firmware::DEFAULT.build()?;
    }
    let mut command = cargo();
    command.args(["run", "--quiet", "--package", "system-tests", "--bin", program, "--"]).args(arguments);
    let status =
        command.status().map_err(|source| ChoreError::NotStarted { program: program.into(), source })?;
    let code = status.code().and_then(|code| u8::try_from(code).ok());
    Ok(code.map_or(ExitCode::FAILURE, ExitCode::from))
}
