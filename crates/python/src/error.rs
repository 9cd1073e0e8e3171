//! Errors as exceptions.

use host_sim::cli::error::CliError;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::{PyErr, create_exception};

create_exception!(
    pintle,
    InputError,
    PyValueError,
    "The input is wrong; the text names file or field, what was found and what was expected."
);
create_exception!(pintle, WorkError, PyRuntimeError, "The work failed.");

/// Makes an exception of a command's error.
pub(crate) fn of_command(error: CliError) -> PyErr {
    match error {
        CliError::Input(text) => InputError::new_err(text),
        CliError::Work(text) => WorkError::new_err(text),
    }
}

/// Makes an exception of wrong input.
pub(crate) fn input(error: impl std::fmt::Display) -> PyErr {
    InputError::new_err(error.to_string())
}

/// Makes an exception of failed work.
pub(crate) fn work(error: impl std::fmt::Display) -> PyErr {
    WorkError::new_err(error.to_string())
}
