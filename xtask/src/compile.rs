//! Building for a controller, with rustup's core library or with Debian's sources.

use crate::run::{ChoreError, cargo};
use crate::setup::{DEBIAN_CARGO, DEBIAN_RUSTC, Way, linker};
use std::path::Path;
use std::process::Command;

/// `cargo build` for a target in a folder, still without the arguments that say what.
pub(crate) fn build(way: &Way, target: &str, folder: &Path) -> Result<Command, ChoreError> {
    let mut command = match way {
        Way::Rustup => cargo(),
        Way::Debian => Command::new(DEBIAN_CARGO),
    };
    command.current_dir(folder).args(["build", "--target", target]);
    if *way == Way::Debian {
        let variable = target.to_uppercase().replace(['-', '.'], "_");
        command
            .arg("-Zbuild-std=core")
            .env("RUSTC", DEBIAN_RUSTC)
            .env("RUSTC_BOOTSTRAP", "1")
            .env(format!("CARGO_TARGET_{variable}_LINKER"), linker()?)
            .env_remove("RUSTUP_TOOLCHAIN");
    }
    Ok(command)
}
