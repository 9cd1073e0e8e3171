//! Static library for C (`crates/c-interface`), for the default controller and for this machine.

use crate::compile::{self, host};
use crate::run::{ChoreError, copy, root, run, target_folder};
use crate::setup::{TARGET, Toolchain, target};
use std::path::PathBuf;

/// File of a library in the folder of its platform.
pub(crate) const FILE: &str = "libpintle_model.a";

/// Builds the libraries and returns the folder with `PLATFORM/libpintle_model.a`.
pub(crate) fn build() -> Result<PathBuf, ChoreError> {
    let folder = target_folder().join("c-libraries");
    let host = host()?;
    for (platform, toolchain) in [(TARGET, target(TARGET)?), (host.as_str(), Toolchain::Rustup)] {
        let mut command = compile::subcommand("rustc", &toolchain, platform, root())?;
        command.args(["--quiet", "--locked", "--profile", "c-library", "--package", "c-interface", "--lib"]);
        command.args(["--crate-type", "staticlib"]);
        // No path of this machine in the text of an error.
        command.env("RUSTFLAGS", format!("--remap-path-prefix={}=pintle", root().display()));
        run(&mut command)?;
        let built = target_folder().join(platform).join("c-library").join(FILE);
        copy(&built, &folder.join(platform).join(FILE))?;
    }
    Ok(folder)
}
