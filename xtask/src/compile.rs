//! Building for a controller, with rustup's core library or with Debian's sources.

use crate::run::{ChoreError, cargo, output_of, root};
use crate::setup::{DEBIAN_CARGO, DEBIAN_RUSTC, Toolchain, linker};
use std::path::Path;
use std::process::Command;

/// Returns `cargo build` for a target in a folder; the caller adds the package.
pub(crate) fn build(toolchain: &Toolchain, target: &str, folder: &Path) -> Result<Command, ChoreError> {
    subcommand("build", toolchain, target, folder)
}

/// Returns a subcommand of cargo that compiles for a target in a folder.
pub(crate) fn subcommand(
    name: &str,
    toolchain: &Toolchain,
    target: &str,
    folder: &Path,
) -> Result<Command, ChoreError> {
    let mut command = match toolchain {
        Toolchain::Rustup => cargo(),
        Toolchain::Debian => Command::new(DEBIAN_CARGO),
    };
    command.current_dir(folder).args([name, "--target", target]);
    if *toolchain == Toolchain::Debian {
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

/// Returns the triple of this machine.
pub(crate) fn host() -> Result<String, ChoreError> {
    let text = output_of(Command::new("rustc").arg("-vV").current_dir(root()))?;
    let triple = text.lines().find_map(|line| line.strip_prefix("host: ")).map(str::to_owned);
    triple.ok_or_else(|| ChoreError::ByHand("`rustc -vV` names no host".into()))
}
