//! What can go wrong with a controller, and what to do about it.

use link::start::{ResetReason, StartReport};
use link::{FrameError, Refused};
use std::path::PathBuf;

/// Why a controller could not be used any further.
#[derive(Debug, thiserror::Error)]
pub enum ControllerError {
    /// The emulator is not installed.
    #[error(
        "qemu-system-arm was not found; install it with `apt-get install qemu-system-arm`, or let `cargo xtask setup` do it"
    )]
    EmulatorMissing,
    /// There is no firmware.
    #[error("{path}: no firmware there; build it with `cargo xtask firmware`, or name one with --elf", path = path.display())]
    FirmwareMissing {
        /// Where it was looked for.
        path: PathBuf,
    },
    /// There is something else.
    #[error("{path}: found {found}; expected the image that `cargo xtask firmware` builds", path = path.display())]
    NotFirmware {
        /// What was to be run.
        path: PathBuf,
        /// What it was, or what became of it.
        found: String,
    },
    /// The operating system refused something.
    #[error("{what}: {source}")]
    System {
        /// What was tried.
        what: &'static str,
        /// Its answer.
        source: std::io::Error,
    },
    /// A port cannot be used.
    #[error("{path}: {source}; expected a serial port with a controller", path = path.display())]
    Port {
        /// The port.
        path: PathBuf,
        /// The system's answer.
        source: std::io::Error,
    },
    /// The probe did not do what it should.
    #[cfg(feature = "probe")]
    #[error(transparent)]
    Probe(#[from] crate::flash::FlashError),
    /// The board runs something else.
    #[cfg(feature = "probe")]
    #[error(
        "{path}: found build {found} on the board; expected {expected}, that of this image: flash it, or name with --elf what is on board",
        path = path.display()
    )]
    OtherImage {
        /// The image.
        path: PathBuf,
        /// The build on the board.
        found: String,
        /// That of the image.
        expected: String,
    },
    /// No answer within the bound.
    #[error("no answer to {waiting_for} within {bound_s} s; last sequence number answered: {last}. {cause}", last = last(*last_sequence))]
    TimedOut {
        /// What was waited for.
        waiting_for: &'static str,
        /// The bound in s, rounded up.
        bound_s: u64,
        /// The last sample that was answered.
        last_sequence: Option<u32>,
        /// The likely cause.
        cause: &'static str,
    },
    /// The controller has gone.
    #[error("the controller ended ({status}); last sequence number answered: {last}. {said}", last = last(*last_sequence))]
    Ended {
        /// How it ended.
        status: String,
        /// The last sample that was answered.
        last_sequence: Option<u32>,
        /// The first line of what the emulator said, if anything; of a port the likely cause.
        said: String,
    },
    /// It speaks another version of the protocol.
    #[error(
        "the controller speaks protocol {found}; expected {expected}: firmware and host come from different builds"
    )]
    Version {
        /// Found.
        found: u8,
        /// Expected.
        expected: u8,
    },
    /// It did not carry a command out.
    #[error("the controller refused: {}", why(_0))]
    Refused(Refused),
    /// A frame came damaged.
    #[error("a damaged frame on the link: {0:?}")]
    Frame(FrameError),
    /// It greeted in the middle of a run.
    #[error("the controller restarted ({}); last sequence number answered: {last}", started(start), last = last(*last_sequence))]
    Restarted {
        /// The last sample that was answered.
        last_sequence: Option<u32>,
        /// What it said of its start.
        start: Box<StartReport>,
    },
    /// Whoever watched the run ended it.
    #[error("stopped by control-C after sample {last_sequence}")]
    Interrupted {
        /// The last sample that was answered.
        last_sequence: u32,
    },
    /// It has taken a sample, and its estimate did not come.
    #[error(
        "the estimate of sample {sequence} was lost on the line ({damaged} damaged frames so far); last sequence number answered: {last}. \
         Line speed, cable or ground may be wrong.",
        last = last(*last_sequence)
    )]
    Lost {
        /// The sample.
        sequence: u32,
        /// The last sample that was answered.
        last_sequence: Option<u32>,
        /// Damaged frames received.
        damaged: u32,
    },
    /// Something else, in the middle of a run.
    #[error("{cause}; last sequence number answered: {last}", last = last(*last_sequence))]
    DuringRun {
        /// The last sample that was answered.
        last_sequence: Option<u32>,
        /// What it was.
        cause: Box<Self>,
    },
    /// It answered something else.
    #[error("unexpected answer {found}; expected {expected}")]
    Unexpected {
        /// What came.
        found: String,
        /// What should have come.
        expected: String,
    },
}

/// A refusal in words.
fn why(refused: &Refused) -> String {
    match refused {
        Refused::Configuration(reasons) => {
            let mut told: Vec<_> = reasons
                .iter()
                .map(|r| format!("{:?}: found {}, expected {} to {}", r.field, r.found, r.min, r.max))
                .collect();
            let more = usize::from(reasons.count).saturating_sub(told.len());
            if more > 0 {
                told.push(format!("and {more} more"));
            }
            told.join("; ")
        }
        Refused::OutOfOrder { expected } => {
            format!("the command's number does not follow; expected {expected}")
        }
        Refused::NumberTaken => "another command has had this number".into(),
        Refused::Image { cause } => {
            format!("the model image on board is damaged or for another bearing (cause {cause})")
        }
        Refused::NotConfigured => "nothing is configured".into(),
        Refused::Running => "a run is going on; stop it first".into(),
        Refused::NotKept => "the configuration could not be kept: nowhere to, or the flash failed".into(),
        Refused::NoSensors => "it has no sensors of its own, or is not paced by its timer".into(),
    }
}

impl ControllerError {
    /// This error with the last sample that was answered, where it does not tell by itself.
    #[must_use]
    pub fn after(self, last_sequence: Option<u32>) -> Self {
        match self {
            Self::TimedOut { .. }
            | Self::Ended { .. }
            | Self::Restarted { .. }
            | Self::Lost { .. }
            | Self::DuringRun { .. } => self,
            cause => Self::DuringRun { last_sequence, cause: Box::new(cause) },
        }
    }
}

/// Why a controller started, in words.
fn started(start: &StartReport) -> String {
    let reason = match start.reason {
        ResetReason::Unknown => "it does not say why",
        ResetReason::PowerOn => "its supply came on",
        ResetReason::BrownOut => "its supply dipped",
        ResetReason::Pin => "reset pin",
        ResetReason::Software => "on command or after an update",
        ResetReason::Watchdog => "watchdog",
        ResetReason::WindowWatchdog => "window watchdog",
        ResetReason::LowPower => "forbidden low-power mode",
        ResetReason::Fault => "after a fault",
        ResetReason::Starved => "a missed check-in",
    };
    match &start.fault {
        Some(fault) => format!("{reason}: {fault}"),
        None => reason.into(),
    }
}

fn last(sequence: Option<u32>) -> String {
    sequence.map_or_else(|| "none".into(), |s| s.to_string())
}
