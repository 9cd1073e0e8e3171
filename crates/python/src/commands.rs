//! Commands of the programs in this process.

use crate::error::of_command;
use host_sim::program;
use pyo3::{PyResult, Python, pyfunction};
use std::ffi::OsString;
use std::sync::{Mutex, PoisonError};

/// Held by a command: options for the terminal and the origin of results are those of the process.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

fn one_at_a_time<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> T {
    py.detach(|| {
        let _held = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
        work()
    })
}

/// Runs a command of `host-sim` without its summary; the arguments begin with the command. Raises
/// its error.
#[pyfunction]
pub(crate) fn call_host_sim(py: Python<'_>, arguments: Vec<OsString>) -> PyResult<()> {
    let complete = ["host-sim".into()].into_iter().chain(arguments).chain(["--quiet".into()]).collect();
    one_at_a_time(py, || program::call(complete)).map_err(of_command)
}

/// Runs the program `host-sim` with arguments, the first of which is its name, and returns its exit
/// code.
#[pyfunction]
pub(crate) fn run_host_sim(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    one_at_a_time(py, || program::run_with(arguments))
}

/// Runs the program `model-quant` with arguments, the first of which is its name, and returns its
/// exit code.
#[pyfunction]
pub(crate) fn run_model_quant(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    one_at_a_time(py, || model_quant::cli::run_with(arguments))
}
