//! Library of exported functional mock-up units, and their check with other programs.

use crate::compile::{self, host};
use crate::environment;
use crate::run::{ChoreError, copy, output_of, root, run, target_folder};
use crate::setup::Toolchain;
use crate::workspace;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Platforms of a library: Rust's target, folder of FMI 2.0, file that cargo links, file in a unit.
const PLATFORMS: [(&str, &str, &str, &str); 2] = [
    ("x86_64-unknown-linux-gnu", "linux64", "libpintle_fmu.so", "pintle_fmu.so"),
    ("x86_64-pc-windows-gnu", "win64", "pintle_fmu.dll", "pintle_fmu.dll"),
];

/// Units that the check exports: kind and description.
const UNITS: [(&str, &str); 3] =
    [("contact", "bench-b"), ("bench", "bench-b"), ("mechanism", "examples/four-bar.toml")];

/// Builds the library for every platform whose target is installed, and prints what was left out.
/// Returns the folder with `linux64/pintle_fmu.so` and its like.
pub(crate) fn build() -> Result<PathBuf, ChoreError> {
    let folder = target_folder().join("fmu-libraries");
    let host = host()?;
    for (target, platform, built, file) in PLATFORMS {
        if target != host && !has_target(target) {
            println!("{platform}: not built: rustup has no core library for {target}");
            continue;
        }
        let mut command = compile::subcommand("build", &Toolchain::Rustup, target, root())?;
        command.args(["--quiet", "--locked", "--profile", "fmu-library", "--package", "fmu", "--lib"]);
        // No path of this machine in the text of an error.
        let home = std::env::var("CARGO_HOME").unwrap_or_else(|_| {
            std::env::home_dir().unwrap_or_default().join(".cargo").display().to_string()
        });
        let remapped =
            format!("--remap-path-prefix={}=pintle --remap-path-prefix={home}=cargo", root().display());
        run(command.env("RUSTFLAGS", remapped))?;
        let built = target_folder().join(target).join("fmu-library").join(built);
        copy(&built, &folder.join(platform).join(file))?;
    }
    Ok(folder)
}

fn has_target(target: &str) -> bool {
    let folder = output_of(Command::new("rustc").args(["--print", "target-libdir", "--target", target]));
    folder.is_ok_and(|folder| Path::new(folder.trim()).is_dir())
}

/// Builds the libraries and prints their folder, or checks exported units with other programs.
pub(crate) fn build_or_check(is_checked: bool) -> Result<(), ChoreError> {
    if is_checked {
        check()?.iter().for_each(|what| println!("not compared or run: {what}"));
    } else {
        println!("{}", build()?.display());
    }
    Ok(())
}

/// Exports every kind of unit for both versions and runs `check.py` on them in a virtual
/// environment. Returns what was skipped.
pub(crate) fn check() -> Result<Vec<String>, ChoreError> {
    let masters = root().join("crates/fmu/tests/masters");
    let folder = target_folder().join("fmu-check");
    let python = match environment::kept(&folder.join("python"), &masters.join("requirements.txt")) {
        Ok(python) => python,
        Err(error) => return Ok(vec![format!("units in other programs: {error}")]),
    };
    let mut files = Vec::new();
    for (kind, bench) in UNITS {
        for version in ["2.0", "3.0"] {
            let file = folder.join(format!("{kind}-{version}.fmu"));
            let mut export = workspace::program("host-sim")?;
            export.args(["export-fmu", kind, "--bench", bench, "--fmi", version, "--json", "--out"]);
            output_of(export.arg(&file))?;
            files.push(file);
        }
    }
    // libcosim writes its own log to the same stream.
    let found = output_of(Command::new(python).arg(masters.join("check.py")).args(&files))?;
    found.lines().filter(|line| !line.starts_with('[')).for_each(|line| println!("{line}"));
    Ok(Vec::new())
}
