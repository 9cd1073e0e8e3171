//! Tests and programs of the workspace, built with the same features.
//!
//! Cargo unites the features of the packages that it builds together, so a package built alone gets
//! other libraries. One choice of packages and features lets every check use the same ones.

use crate::run::{ChoreError, cargo, root, run, target_folder};
use std::process::Command;

/// Features of all builds; those of the emulator's tests.
const FEATURES: &str = "system-tests/emulated";

/// Returns the command that runs the tests of all packages, those on the emulator included.
pub(crate) fn tests() -> Command {
    let mut command = cargo();
    command.args(["test", "--workspace", "--features", FEATURES]);
    command
}

/// Returns the command that runs one test on the emulator.
pub(crate) fn emulator_test(name: &str) -> Command {
    let mut command = tests();
    command.args(["--quiet", "--test", "emulator", "--", "--exact", name]);
    command
}

/// Builds the host's programs, and returns the command that starts one.
pub(crate) fn program(name: &str) -> Result<Command, ChoreError> {
    // Tests of the command line need the programs themselves.
    run(tests().args(["--quiet", "--no-run", "--test", "cli"]))?;
    let mut command = Command::new(target_folder().join("debug").join(name));
    command.current_dir(root());
    Ok(command)
}
