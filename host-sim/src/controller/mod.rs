//! The controller's ends: the same conversation in this process, with the emulated controller, with a board on a serial port and
//! with a board at a debug probe.
//!
//! Lockstep: the sensor frame's time is the controller's time, and the host waits for the estimate of every frame. Every
//! wait is bounded and names what it waited for. A restarted controller is noticed by its unasked greeting, or, when that was lost, by
//! the number of its last command. A [`Recorder`] hears every frame either way.

mod attached;
mod conversation;
mod emulated;
mod error;
mod greeting;
mod line;
mod native;
mod one_core;
#[cfg(feature = "probe")]
mod probe;
mod recorder;
pub mod recording;
mod remote;
pub mod replay;
mod stream;

pub use attached::{AttachedController, BAUD, BOUNDS};
pub use conversation::{Conversation, Heard, Losses};
pub use emulated::EmulatedController;
pub use error::ControllerError;
pub use line::Bounds;
pub use native::NativeController;
#[cfg(feature = "probe")]
pub use probe::ProbedController;
pub use recorder::{RecordedFrame, Recorder, Way};
pub use recording::Recording;
pub use remote::RemoteController;

use link::track::SensorStatus;
use link::{Answer, Command, Counters, EstimateFrame, Hello, MAX_FRAME, SensorFrame, SlowFrame, encode};

/// A configured controller.
pub trait Controller {
    /// Where it runs, in a word.
    fn name(&self) -> &'static str;
    /// Who it said it is.
    fn hello(&self) -> &Hello;
    /// Has every frame heard from now on.
    fn listen(&mut self, recorder: Recorder);
    /// Gives it a sample, with what the drivers say about it, and takes its estimate.
    fn sample(&mut self, frame: &SensorFrame, status: SensorStatus)
    -> Result<EstimateFrame, ControllerError>;
    /// Gives it a sample that nothing is to be said about, and takes its estimate.
    fn exchange(&mut self, frame: &SensorFrame) -> Result<EstimateFrame, ControllerError> {
        self.sample(frame, SensorStatus::GOOD)
    }
    /// Ends the run and takes its counters.
    fn finish(self: Box<Self>) -> Result<Counters, ControllerError>;
    /// Gives it a command and takes the answer.
    fn order(&mut self, command: Command) -> Result<Answer, ControllerError>;
    /// The last frame of slow telemetry that came, and what was lost.
    fn heard(&self) -> (Option<SlowFrame>, Losses);
}

/// What [`Controller::finish`] is for all of them.
fn stopped(answer: Answer) -> Result<Counters, ControllerError> {
    match answer {
        Answer::Stopped(counters) => Ok(counters),
        other => Err(unexpected(&other, "the counters")),
    }
}

fn system(what: &'static str) -> impl Fn(std::io::Error) -> ControllerError {
    move |source| ControllerError::System { what, source }
}

fn unexpected(found: &impl std::fmt::Debug, expected: &str) -> ControllerError {
    ControllerError::Unexpected { found: format!("{found:?}"), expected: expected.into() }
}

/// A message as it goes over a line.
fn framed<'a>(
    message: &impl serde::Serialize,
    buffer: &'a mut [u8; MAX_FRAME],
) -> Result<&'a [u8], ControllerError> {
    encode(message, buffer).map_err(|error| unexpected(&error, "a message that fits a frame"))
}
