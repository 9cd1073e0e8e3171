//! Campaigns: programs of the package `system-tests`. Arguments and exit code are those of the
//! program.

use crate::run::{ChoreError, cargo};
use crate::{firmware, setup};
use std::ffi::OsString;
use std::process::ExitCode;

/// Builds the controller's image and runs a program that emulates it.
pub(crate) fn emulated(program: &'static str, arguments: &[OsString]) -> Result<ExitCode, ChoreError> {
    // The help text needs no image.
    if !arguments.iter().any(|argument| argument == "--help" || argument == "-h") {
        setup::setup()?;
        firmware::DEFAULT.build()?;
    }
    run(program, &[], arguments)
}

/// Runs a program without emulator, in the release profile.
pub(crate) fn computed(program: &'static str, arguments: &[OsString]) -> Result<ExitCode, ChoreError> {
    run(program, &["--release"], arguments)
}

fn run(program: &'static str, profile: &[&str], arguments: &[OsString]) -> Result<ExitCode, ChoreError> {
    let mut command = cargo();
    command.args(["run", "--quiet"]).args(profile);
    command.args(["--package", "system-tests", "--bin", program, "--"]).args(arguments);
    let status =
        command.status().map_err(|source| ChoreError::NotStarted { program: program.into(), source })?;
    let code = status.code().and_then(|code| u8::try_from(code).ok());
    Ok(code.map_or(ExitCode::FAILURE, ExitCode::from))
}
