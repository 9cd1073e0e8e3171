//! The fault campaign: seeded faults on the emulated controller, each classed by what the host gets to hear.
//!
//! | part | what |
//! |---|---|
//! | [`gdb`], [`emulator`] | the emulator with its link and its debugger's stub |
//! | [`image`], [`trace`] | where the controller's memory is; what a tick carries out |
//! | [`stage`] | the samples and the sound estimates |
//! | [`plan`], [`streams`] | which fault a number stands for; faults of samples and frames |
//! | [`attempt`], [`judge`] | one fault carried out and classed |
//! | [`native`] | one fault of a sensor without an emulator |
//! | [`campaign`], [`table`] | many of them on all cores; counts by kind and class |
//!
//! A fault is a function of campaign seed and number: what it does, and when, repeats exactly. What is counted as what is told in [`judge`].

pub mod attempt;
pub mod campaign;
pub mod emulator;
pub mod gdb;
pub mod image;
pub mod judge;
pub mod native;
pub mod plan;
pub mod stage;
pub mod streams;
pub mod table;
pub mod trace;

use crate::journal::JournalError;
use std::path::PathBuf;
use std::process::ExitCode;

/// Why the campaign could not go on.
#[derive(Debug, thiserror::Error)]
pub enum CampaignError {
    /// The operating system refused something.
    #[error("{what}: {source}")]
    System {
        /// What was tried.
        what: &'static str,
        /// Its answer.
        source: std::io::Error,
    },
    /// The debugger's stub.
    #[error("the emulator's debugger: found {found}; expected {expected}")]
    Debugger {
        /// What it said.
        found: String,
        /// What it should have said.
        expected: &'static str,
    },
    /// The image.
    #[error("{path}: expected {expected}; build it with `cargo xtask firmware`", path = path.display())]
    Image {
        /// Where.
        path: PathBuf,
        /// What was looked for.
        expected: &'static str,
    },
    /// Something else than what should be.
    #[error("found {found}; expected {expected}")]
    Unexpected {
        /// What was found.
        found: String,
        /// What was expected.
        expected: &'static str,
    },
    /// The journal of outcomes.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The bench.
    #[error(transparent)]
    Bench(#[from] host_sim::error::CliError),
    /// The controller in this process.
    #[error(transparent)]
    Controller(#[from] host_sim::controller::ControllerError),
}

/// The exit code of a campaign's program: 0 sound, 1 not or the work failed, 2 the input is wrong. What failed is told.
pub fn exit(result: Result<bool, CampaignError>) -> ExitCode {
    match result {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(match error {
                CampaignError::Image { .. } | CampaignError::Journal(JournalError::Other { .. }) => 2,
                _ => 1,
            })
        }
    }
}

/// SplitMix64: small, and the same everywhere.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// The stream of a number in a campaign.
    pub fn new(seed: u64, number: u64) -> Self {
        let mut random = Self(seed ^ number.wrapping_mul(0xD134_2543_DE82_EF95));
        random.bits();
        random
    }

    /// 64 random bits.
    pub const fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }

    /// Below a number; 0 below 0.
    pub const fn below(&mut self, end: u32) -> u32 {
        (((self.bits() >> 32) * end as u64) >> 32) as u32
    }

    /// Uniform in 0..1.
    pub const fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// About normal, with deviation 1: the sum of twelve uniform ones.
    pub fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.unit()).sum::<f64>() - 6.0
    }
}
