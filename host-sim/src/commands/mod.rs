//! The commands, one file each: arguments, work, output.

pub mod accuracy;
mod accuracy_pictures;
mod accuracy_report;
pub mod diagnose;
mod diagnose_pictures;
mod diagnose_report;
pub mod figures;
pub mod flash;
pub mod laws;
mod limits;
pub mod link;
mod link_words;
mod output;
pub mod record;
pub mod run;
mod run_report;
mod run_tilt;
mod slider_crank;
pub mod sweep;
mod sweep_file;
mod sweep_latch;
mod sweep_paper;
mod sweep_paper_pictures;
pub mod update;
pub mod validate;
