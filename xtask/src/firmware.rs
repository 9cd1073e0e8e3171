//! Building the firmware's image.

use crate::run::{ChoreError, cargo, run, target_folder};
use crate::setup::{DEBIAN_CARGO, DEBIAN_RUSTC, TARGET, Way, linker};
use std::path::PathBuf;
use std::process::Command;

const BUILD: [&str; 11] = [
    "build",
    "--profile",
    "firmware",
    "--package",
    "firmware",
    "--bin",
    "estimator",
    "--features",
    "board",
    "--target",
    TARGET,
];

/// Builds the image and says where it is.
pub(crate) fn build(way: &Way) -> Result<PathBuf, ChoreError> {
    match way {
        Way::Rustup => run(cargo().args(BUILD))?,
        Way::Debian => {
            let mut command = Command::new(DEBIAN_CARGO);
            command
                .current_dir(crate::run::root())
                .args(BUILD)
                .arg("-Zbuild-std=core")
                .env("RUSTC", DEBIAN_RUSTC)
                .env("RUSTC_BOOTSTRAP", "1")
                .env("CARGO_TARGET_THUMBV7EM_NONE_EABIHF_LINKER", linker()?)
                .env_remove("RUSTUP_TOOLCHAIN");
            run(&mut command)?;
        }
    }
    Ok(target_folder().join(TARGET).join("firmware/estimator"))
}
