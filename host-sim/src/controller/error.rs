//! Errors of a controller, each with its likely cause or remedy.

use crate::cli::error::CliError;
use link::start::{ResetReason, StartReport};
use link::{FrameError, Refusal};
use std::path::PathBuf;

/// Why a controller cannot be used any further.
#[derive(Debug, thiserror::Error)]
pub enum ControllerError {
    /// The emulator is not installed.
    #[error(
        "qemu-system-arm was not found; install it with `apt-get install qemu-system-arm`, or let `cargo \
         xtask setup` do it"
    )]
    EmulatorMissing,
    /// The firmware image is missing.
    #[error(
        "{path}: no firmware there; build it with `cargo xtask firmware`, or name one with --elf",
        path = path.display()
    )]
    FirmwareMissing {
        /// Expected path.
        path: PathBuf,
    },
    /// The file is not a firmware image.
    #[error(
        "{path}: found {found}; expected the image that `cargo xtask firmware` builds",
        path = path.display()
    )]
    NotFirmware {
        /// The file.
        path: PathBuf,
        /// Description of what was found.
        found: String,
    },
    /// A system call failed.
    #[error("{what}: {source}")]
    System {
        /// The attempted operation.
        what: &'static str,
        /// Error of the system.
        source: std::io::Error,
    },
    /// A port cannot be used.
    #[error("{path}: {source}; expected a serial port with a controller", path = path.display())]
    Port {
        /// The port.
        path: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
    /// The debug probe failed.
    #[cfg(feature = "probe")]
    #[error(transparent)]
    Probe(#[from] crate::flash::FlashError),
    /// The board runs another build.
    #[cfg(feature = "probe")]
    #[error(
        "{path}: found build {found} on the board; expected {expected}, the build of this image: \
         flash it, or name the image on board with --elf",
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
    /// No answer within the timeout.
    #[error(
        "no answer to {waiting_for} within {timeout_s} s; last sequence number answered: {last}. {cause}",
        last = last(*last_sequence)
    )]
    TimedOut {
        /// The request.
        waiting_for: &'static str,
        /// Timeout in s, rounded up.
        timeout_s: u64,
        /// The last sample that was answered.
        last_sequence: Option<u32>,
        /// The likely cause.
        cause: &'static str,
    },
    /// The controller ended or was disconnected.
    #[error(
        "the controller ended ({status}); last sequence number answered: {last}. {message}",
        last = last(*last_sequence)
    )]
    Ended {
        /// Exit status, or how the connection ended.
        status: String,
        /// The last sample that was answered.
        last_sequence: Option<u32>,
        /// First line of the emulator's error output; for a port the likely cause.
        message: String,
    },
    /// It uses another version of the protocol.
    #[error(
        "the controller uses protocol {found}; expected {expected}: firmware and host come from different \
         builds"
    )]
    Version {
        /// Found.
        found: u8,
        /// Expected.
        expected: u8,
    },
    /// It refused a command.
    #[error("the controller refused: {}", describe_refusal(_0))]
    Refused(Refusal),
    /// It has another key of the link, or a forged frame arrived in its name.
    #[error("the key of the link is not the controller's; expected the one that its firmware was built with")]
    WrongKey,
    /// It requires no key, but one was given.
    #[error(
        "--link-key: found a controller whose firmware has no key (or a forged frame in its name); expected \
         one that was built with PINTLE_LINK_KEY"
    )]
    NeedlessKey,
    /// A damaged frame on a link that loses nothing.
    #[error("a damaged frame on the link: {0:?}")]
    Frame(FrameError),
    /// It restarted in the middle of a run.
    #[error(
        "the controller restarted ({}); last sequence number answered: {last}",
        describe_start(start),
        last = last(*last_sequence)
    )]
    Restarted {
        /// The last sample that was answered.
        last_sequence: Option<u32>,
        /// Its report about the start.
        start: Box<StartReport>,
    },
    /// The user ended the run in the live view.
    #[error("stopped by control-C after sample {last_sequence}")]
    Interrupted {
        /// The last sample that was answered.
        last_sequence: u32,
    },
    /// It received a sample, but its estimate was lost.
    #[error(
        "the estimate of sample {sequence} was lost on the line ({damaged} damaged frames so far); \
         last sequence number answered: {last}. \
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
    /// Another error in the middle of a run.
    #[error("{cause}; last sequence number answered: {last}", last = last(*last_sequence))]
    DuringRun {
        /// The last sample that was answered.
        last_sequence: Option<u32>,
        /// The error.
        cause: Box<Self>,
    },
    /// It sent an unexpected answer.
    #[error("unexpected answer {found}; expected {expected}")]
    Unexpected {
        /// The answer.
        found: String,
        /// The expected answer.
        expected: String,
    },
}

/// Describes a refusal.
fn describe_refusal(refused: &Refusal) -> String {
    match refused {
        Refusal::Configuration(reasons) => {
            let mut listed: Vec<_> = reasons
                .iter()
                .map(|r| format!("{:?}: found {}, expected {} to {}", r.field, r.found, r.min, r.max))
                .collect();
            let more = usize::from(reasons.count).saturating_sub(listed.len());
            if more > 0 {
                listed.push(format!("and {more} more"));
            }
            listed.join("; ")
        }
        Refusal::OutOfOrder { expected } => {
            format!("the command's number does not follow; expected {expected}")
        }
        Refusal::NumberTaken => "another command has used this number".into(),
        Refusal::Image { cause } => {
            format!("the model image on board is damaged or for another bearing (cause {cause})")
        }
        Refusal::NotConfigured => "it is not configured".into(),
        Refusal::Running => "a run is active; stop it first".into(),
        Refusal::NotKept => {
            "the configuration or the number of its start could not be saved: no memory, or the flash failed"
                .into()
        }
        Refusal::NotAuthenticated => {
            "it executes this command only with the key of its link; give the key with --link-key".into()
        }
        Refusal::NoSensors => "it has no sensors, or is not paced by its timer".into(),
    }
}

impl ControllerError {
    /// Adds the last answered sample, unless the error already contains it.
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

/// Describes the reason of a start.
fn describe_start(start: &StartReport) -> String {
    let reason = match start.reason {
        ResetReason::Unknown => "reason not reported",
        ResetReason::PowerOn => "power-on",
        ResetReason::BrownOut => "supply voltage dipped",
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

impl From<ControllerError> for CliError {
    fn from(error: ControllerError) -> Self {
        match error {
            ControllerError::Port { .. }
            | ControllerError::FirmwareMissing { .. }
            | ControllerError::NotFirmware { .. }
            | ControllerError::WrongKey
            | ControllerError::NeedlessKey
            | ControllerError::Refused(Refusal::NotAuthenticated) => Self::Input(error.to_string()),
            #[cfg(feature = "probe")]
            ControllerError::Probe(error) => error.into(),
            other => Self::Work(other.to_string()),
        }
    }
}

/// Returns a conversion of a system's error.
pub(super) fn system(what: &'static str) -> impl Fn(std::io::Error) -> ControllerError {
    move |source| ControllerError::System { what, source }
}

/// Returns the error of an answer other than the expected one.
pub(super) fn unexpected(found: &impl std::fmt::Debug, expected: &str) -> ControllerError {
    ControllerError::Unexpected { found: format!("{found:?}"), expected: expected.into() }
}
