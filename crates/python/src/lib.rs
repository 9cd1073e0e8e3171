//! Native part of the Python package `pintle`: what works on arrays, and the commands of the
//! programs. `python/pintle` makes classes and data frames of it.
#![forbid(unsafe_code)]

mod arrays;
mod commands;
mod controller;
mod description;
mod error;
mod logs;
mod networks;
mod training;

/// Native part of the package.
#[pyo3::pymodule(name = "_native")]
mod native {
    #[pymodule_export]
    use crate::commands::{call_host_sim, run_host_sim, run_model_quant};
    #[pymodule_export]
    use crate::controller::Controller;
    #[pymodule_export]
    use crate::description::{
        change_description, contact_forces, open_description, parse_description, presets,
    };
    #[pymodule_export]
    use crate::error::{InputError, WorkError};
    #[pymodule_export]
    use crate::logs::{channels, read_log, read_samples, write_log};
    #[pymodule_export]
    use crate::networks::Networks;
    #[pymodule_export]
    use crate::training::{package, quantise, train, verify};
}
