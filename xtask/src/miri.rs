//! The crate `inference` under Miri, which finds undefined behaviour. Needs the nightly toolchain.

use crate::run::{ChoreError, root, run, succeeds};
use std::process::Command;

/// Installs Miri if it is missing and runs the tests that finish in about ten minutes.
pub(crate) fn miri() -> Result<(), ChoreError> {
    let toolchain = ["--toolchain", "nightly"];
    if !succeeds(Command::new("cargo").args(["+nightly", "miri", "--version"])) {
        run(Command::new("rustup").args(["toolchain", "install", "nightly", "--profile", "minimal"]))?;
        run(Command::new("rustup").args(["component", "add", "miri", "rust-src"]).args(toolchain))?;
    }
    let mut command = Command::new("cargo");
    command.current_dir(root()).args(["+nightly", "miri", "test", "--package", "inference"]);
    // Cargo sets these variables to the project's toolchain.
    command.env_remove("RUSTUP_TOOLCHAIN").env_remove("CARGO").env_remove("RUSTC");
    command.env("MIRIFLAGS", "-Zmiri-disable-isolation").env("PROPTEST_CASES", "2");
    run(command.args(["--lib", "--test", "modes"]))
}
