//! The commands, one file each: arguments, work, output.

pub mod diagnose;
mod diagnose_report;
pub mod record;
pub mod run;
mod run_report;
pub mod validate;
