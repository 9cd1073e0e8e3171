//! Commands of the programs in this process.

use crate::error::{input, of_command, work};
use host_sim::program;
use pyo3::{PyResult, Python, pyfunction};
use std::ffi::OsString;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::Duration;

/// Held by a command: options for the terminal and the origin of results are those of the process.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

/// Process that called first. The worker threads of the libraries do not survive a fork.
static PROCESS: OnceLock<u32> = OnceLock::new();

/// Time between two looks for an interruption.
const LOOK_PERIOD: Duration = Duration::from_millis(50);

/// Runs `task` in a thread, so that Python notices control-C meanwhile. After that the thread
/// continues in the background, and the next call waits for it.
fn one_at_a_time<T: Send + 'static>(
    py: Python<'_>,
    task: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    if *PROCESS.get_or_init(std::process::id) != std::process::id() {
        return Err(input(
            "found a process that was forked after a command; expected multiprocessing with the start \
             method `spawn`",
        ));
    }
    let (sender, receiver) = channel();
    let thread = move || {
        let _held = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
        // The result of an interrupted call is lost.
        let _ = sender.send(task());
    };
    std::thread::Builder::new().spawn(thread).map_err(work)?;
    let receiver = Mutex::new(receiver);
    loop {
        let wait = || receiver.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(LOOK_PERIOD);
        match py.detach(wait) {
            Ok(result) => return Ok(result),
            Err(RecvTimeoutError::Timeout) => py.check_signals()?,
            Err(RecvTimeoutError::Disconnected) => return Err(work("the command ended with a panic")),
        }
    }
}

/// Runs a command of `host-sim` and returns its output; the arguments begin with the command.
/// Raises its error.
#[pyfunction]
pub(crate) fn call_host_sim(py: Python<'_>, arguments: Vec<OsString>) -> PyResult<String> {
    let complete = ["host-sim".into()].into_iter().chain(arguments).collect();
    one_at_a_time(py, || program::call(complete))?.map_err(of_command)
}

/// Runs the program `host-sim` with arguments, the first of which is its name, and returns its exit
/// code.
#[pyfunction]
pub(crate) fn run_host_sim(py: Python<'_>, arguments: Vec<OsString>) -> PyResult<u8> {
    one_at_a_time(py, || program::run_with(arguments))
}

/// Runs the program `model-quant` with arguments, the first of which is its name, and returns its
/// exit code.
#[pyfunction]
pub(crate) fn run_model_quant(py: Python<'_>, arguments: Vec<OsString>) -> PyResult<u8> {
    one_at_a_time(py, || model_quant::cli::run_with(arguments))
}
