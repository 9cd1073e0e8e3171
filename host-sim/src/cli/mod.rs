//! Shared by all commands: error and exit code, options, output folder, progress bar, thread pool.

pub mod console;
pub mod error;
pub(crate) mod label;
pub(crate) mod limits;
pub mod options;
pub(crate) mod output;
pub(crate) mod parallel;
pub(crate) mod progress;
pub(crate) mod provenance;
