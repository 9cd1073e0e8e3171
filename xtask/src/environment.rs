//! Virtual environments of Python for programs and packages that the project does not contain.

use crate::run::{ChoreError, of_file, run, succeeds};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Expectation about the requirements files.
const USABLE: &str = "a file that can be read and written";

/// Creates a virtual environment with the packages of a requirements file unless it exists already,
/// and returns its interpreter.
pub(crate) fn kept(folder: &Path, requirements: &Path) -> Result<PathBuf, ChoreError> {
    let wanted = std::fs::read(requirements).map_err(of_file(requirements, USABLE))?;
    let installed = folder.join("requirements.txt");
    let is_complete = std::fs::read(&installed).is_ok_and(|found| found == wanted);
    if is_complete && succeeds(Command::new(interpreter(folder)).arg("--version")) {
        return Ok(interpreter(folder));
    }
    let python = fresh(folder, requirements)?;
    std::fs::write(&installed, wanted).map_err(of_file(&installed, USABLE))?;
    Ok(python)
}

/// Creates a virtual environment anew with the packages of a requirements file, and returns its
/// interpreter.
pub(crate) fn fresh(folder: &Path, requirements: &Path) -> Result<PathBuf, ChoreError> {
    run(Command::new("python3").args(["-m", "venv", "--clear"]).arg(folder))?;
    install(&interpreter(folder), [OsStr::new("--requirement"), requirements.as_os_str()])?;
    Ok(interpreter(folder))
}

/// Installs what the arguments of `pip install` name.
pub(crate) fn install<const N: usize>(python: &Path, arguments: [&OsStr; N]) -> Result<(), ChoreError> {
    run(Command::new(python).args(["-m", "pip", "install", "--quiet"]).args(arguments))
}

fn interpreter(folder: &Path) -> PathBuf {
    folder.join("bin/python")
}
