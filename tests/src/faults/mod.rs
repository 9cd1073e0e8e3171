//! Fault campaign: seeded faults on the emulated controller, each classified by the host's view.
//!
//! | part | content |
//! |---|---|
//! | [`gdb`], [`emulator`] | the emulator with its link and its debugger stub |
//! | [`image`], [`trace`] | memory map of the controller; instructions of a tick |
//! | [`scenario`] | samples and the estimates without fault |
//! | [`plan`], [`streams`] | the fault of a number; faults of samples and frames |
//! | [`attempt`], [`classify`] | injection of one fault and its class |
//! | [`native`] | a sensor fault without an emulator |
//! | [`campaign`], [`table`] | many faults on all cores; counts by kind and class |
//! | [`publication`] | record of the published campaigns, each with a fresh seed |
//!
//! A fault is a function of campaign seed and number, so it repeats exactly.

pub mod attempt;
pub mod campaign;
pub mod classify;
pub mod emulator;
pub mod gdb;
pub mod image;
pub mod native;
pub mod plan;
pub mod publication;
pub mod scenario;
pub mod streams;
pub mod table;
pub mod trace;
mod wait;

use crate::journal::JournalError;
use crate::random::SplitMix64;
use std::path::PathBuf;
use std::process::ExitCode;

/// Reason why a campaign failed.
#[derive(Debug, thiserror::Error)]
pub enum CampaignError {
    /// The operating system refused a request.
    #[error("{what}: {source}")]
    System {
        /// Request.
        what: &'static str,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The debugger stub sent an unexpected reply.
    #[error("the emulator's debugger: found {found}; expected {expected}")]
    Debugger {
        /// Reply.
        found: String,
        /// Expected reply.
        expected: &'static str,
    },
    /// The firmware image is missing or not usable.
    #[error("{path}: expected {expected}; build it with `cargo xtask firmware`", path = path.display())]
    Image {
        /// Path of the image.
        path: PathBuf,
        /// Expected content.
        expected: &'static str,
    },
    /// A result differs from the expected one.
    #[error("found {found}; expected {expected}")]
    Unexpected {
        /// Result.
        found: String,
        /// Expected result.
        expected: &'static str,
    },
    /// No publication with this seed can be continued.
    #[error(
        "--seed: found {seed}; expected that of an unfinished publication of this build and count, or \
         none: a fresh seed is drawn"
    )]
    NotBegun {
        /// The seed.
        seed: u64,
    },
    /// The image was not built from a commit without changes.
    #[error(
        "found an image of build {build}, commit {commit} and {changes} uncommitted changes; expected an \
         image of the commit and no changes"
    )]
    NotCommitted {
        /// Name of the image's build.
        build: String,
        /// Name of the commit.
        commit: String,
        /// `none` or `some`.
        changes: &'static str,
    },
    /// The journal cannot be used.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The simulation of the bench failed.
    #[error(transparent)]
    Bench(#[from] host_sim::cli::error::CliError),
    /// The controller in this process failed.
    #[error(transparent)]
    Controller(#[from] host_sim::controller::ControllerError),
}

/// Returns the exit code of a campaign's program and prints the error, if any.
///
/// 0: passed; 1: failed, or the work could not be done; 2: the input is wrong.
pub fn exit(result: Result<bool, CampaignError>) -> ExitCode {
    match result {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(match error {
                CampaignError::Image { .. }
                | CampaignError::NotBegun { .. }
                | CampaignError::NotCommitted { .. }
                | CampaignError::Journal(JournalError::Other { .. }) => 2,
                _ => 1,
            })
        }
    }
}

/// Returns the random stream of a fault's number in a campaign.
#[must_use]
pub fn stream(seed: u64, number: u64) -> SplitMix64 {
    let mut random = SplitMix64(seed ^ number.wrapping_mul(0xD134_2543_DE82_EF95));
    random.bits();
    random
}
