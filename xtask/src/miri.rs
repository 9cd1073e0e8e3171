//! The inference crate under Miri, which finds undefined behaviour in what safe faces hide. Needs the nightly toolchain.

use crate::run::{ChoreError, root, run, succeeds};
use std::process::Command;

/// Installs Miri where it is missing and runs the tests that it gets through in about ten minutes.
pub(crate) fn miri() -> Result<(), ChoreError> {
    let toolchain = ["--toolchain", "nightly"];
    if !succeeds(Command::new("cargo").args(["+nightly", "miri", "--version"])) {
        run(Command::new("rustup").args(["toolchain", "install", "nightly", "--profile", "minimal"]))?;
        run(Command::new("rustup").args(["component", "add", "miri", "rust-src"]).args(toolchain))?;
    }
    let mut command = Command::new("cargo");
    command.current_dir(root()).args(["+nightly", "miri", "test", "--package", "inference"]);
    // The calling cargo is pinned to the project's toolchain.
    command.env_remove("RUSTUP_TOOLCHAIN").env_remove("CARGO").env_remove("RUSTC");
    command.env("MIRIFLAGS", "-Zmiri-disable-isolation").env("PROPTEST_CASES", "2");
    run(command.args(["--lib", "--test", "modes"]))
}
