//! Python package: its wheel, and the check of a wheel in a fresh virtual environment.

use crate::environment;
use crate::run::{ChoreError, copy, of_file, output_of, root, run, target_folder};
use crate::workspace;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Expectation about the folders of the package.
const READABLE: &str = "a folder that can be read";
/// Library that cargo builds, below the folder of the profile.
const LIBRARY: &str = "deps/libpintle_native.so";

/// Folder of the package in the workspace.
fn package() -> PathBuf {
    root().join("crates/python")
}

/// Builds the wheel and prints its path, or checks the package.
pub(crate) fn build_or_check(is_checked: bool) -> Result<(), ChoreError> {
    if is_checked {
        check()?.iter().for_each(|what| println!("not compared or run: {what}"));
    } else {
        println!("{}", release()?.display());
    }
    Ok(())
}

/// Environment with the programs that build a wheel.
fn builder() -> Result<PathBuf, ChoreError> {
    environment::kept(&target_folder().join("wheel-builder"), &package().join("builder.txt"))
}

/// Builds the wheel with maturin, and returns its path.
fn release() -> Result<PathBuf, ChoreError> {
    let folder = target_folder().join("wheels");
    let mut build = Command::new(builder()?);
    build.current_dir(package()).args(["-m", "maturin", "build", "--release", "--locked", "--out"]);
    run(build.arg(&folder))?;
    wheel_in(&folder)
}

/// Packs the library that the build of the tests made, with the metadata that maturin gives it. A
/// build by maturin would compile the workspace again with other features.
fn packed(folder: &Path) -> Result<PathBuf, ChoreError> {
    let builder = builder()?;
    run(workspace::tests().args(["--quiet", "--no-run", "--test", "stubs"]))?;
    let tree = folder.join("tree");
    let mut metadata = Command::new(&builder);
    metadata.current_dir(package()).args(["-m", "maturin", "pep517", "write-dist-info"]);
    output_of(metadata.arg("--interpreter").arg(&builder).arg("--metadata-directory").arg(&tree))?;
    let sources = package().join("python/pintle");
    let found = std::fs::read_dir(&sources).map_err(of_file(&sources, READABLE))?;
    for source in found.flatten().map(|entry| entry.path()).filter(|path| path.is_file()) {
        copy(&source, &tree.join("pintle").join(source.file_name().unwrap_or_default()))?;
    }
    copy(&target_folder().join("debug").join(LIBRARY), &tree.join("pintle/_native.abi3.so"))?;
    run(Command::new(&builder).args(["-m", "wheel", "pack", "--dest-dir"]).arg(folder).arg(&tree))?;
    wheel_in(folder)
}

/// The only wheel in a folder.
fn wheel_in(folder: &Path) -> Result<PathBuf, ChoreError> {
    let found = std::fs::read_dir(folder).map_err(of_file(folder, READABLE))?;
    let is_wheel = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "whl");
    let wheels: Vec<PathBuf> = found.flatten().map(|entry| entry.path()).filter(is_wheel).collect();
    match <[PathBuf; 1]>::try_from(wheels) {
        Ok([wheel]) => Ok(wheel),
        Err(wheels) => Err(ChoreError::File {
            file: folder.to_owned(),
            found: format!("{} wheels", wheels.len()),
            expected: "one",
        }),
    }
}

/// Installs a wheel in a fresh virtual environment, and runs the package's tests, the checks of its
/// types and the notebooks there. Returns what was skipped.
pub(crate) fn check() -> Result<Vec<String>, ChoreError> {
    let tests = package().join("tests");
    let folder = target_folder().join("python-check");
    let python = match environment::fresh(&folder, &tests.join("requirements.txt")) {
        Ok(python) => python,
        Err(error) => return Ok(vec![format!("Python package: {error}")]),
    };
    let wheel = packed(&folder.join("wheel"))?;
    environment::install(&python, [wheel.as_os_str()])?;
    let module = |name: &str| {
        let mut command = Command::new(&python);
        // Not the folder of the sources, which Python would import first.
        command.current_dir(&folder).args(["-m", name]);
        command
    };
    run(module("mypy.stubtest").arg("pintle._native"))?;
    run(module("mypy").args(["--strict", "--package", "pintle"]))?;
    run(module("pytest").args(["--quiet", "-p", "no:cacheprovider"]).arg(&tests))?;
    let mut notebooks = Command::new(&python);
    run(notebooks.arg(tests.join("notebooks.py")).arg(root().join("examples/notebooks")))?;
    Ok(Vec::new())
}
