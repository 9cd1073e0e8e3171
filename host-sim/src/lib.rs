//! The host: runs of the bench with the controller's inference code in the loop, records, diagnoses, reports.
//!
//! [`force`] is where a run's bearing force comes from, [`sensing`] what the controller gets to see of it,
//! [`controller`] the ends of the link, [`estimator`] their use, [`same_signals`] what else could be made of the controller's signals, [`watch`] the live view, [`summary`] the figures,
//! [`sweep`] many runs at once, [`accuracy`] how far networks and estimator are off, [`paper`] the runs of the paper's figures and [`claims`] what they say about its claims, [`figure`] and [`page`] what people look at, and
//! [`commands`] the command line.

#[macro_use]
mod say;

pub mod accuracy;
pub mod claims;
pub mod commands;
pub mod controller;
pub mod error;
pub mod estimator;
pub mod flash;
pub mod force;
pub mod options;
pub mod paper;
mod parallel;
pub mod progress;
pub mod same_signals;
pub mod sensing;
pub mod summary;
pub mod sweep;
pub mod swing;
pub mod update;
pub mod watch;

pub use report::{axis, figure, page};
