//! The commands, one file each: arguments, work, output.

pub mod diagnose;
mod diagnose_pictures;
mod diagnose_report;
pub mod record;
pub mod run;
mod run_report;
mod slider_crank;
pub mod validate;
