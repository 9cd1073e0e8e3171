//! The controller's ends: the same conversation in this process, with the emulated controller and with a board on a serial port.
//!
//! Lockstep: the sensor frame's time is the controller's time, and the host waits for the estimate of every frame. Every
//! wait is bounded and names what it waited for. A restarted controller is noticed by its unasked greeting.

mod attached;
mod conversation;
mod emulated;
mod error;
mod native;
mod remote;

pub use attached::{AttachedController, BAUD};
pub use conversation::{Conversation, Heard, Losses};
pub use emulated::EmulatedController;
pub use error::ControllerError;
pub use native::NativeController;
pub use remote::RemoteController;

use link::{
    Answer, Command, Counters, EstimateFrame, Hello, MAGIC, PROTOCOL_VERSION, SensorFrame, SlowFrame,
};

/// A configured controller.
pub trait Controller {
    /// Where it runs, in a word.
    fn name(&self) -> &'static str;
    /// Who it said it is.
    fn hello(&self) -> &Hello;
    /// Gives it a sample and takes its estimate.
    fn exchange(&mut self, frame: &SensorFrame) -> Result<EstimateFrame, ControllerError>;
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

/// Accepts a greeting of this protocol only.
fn greeted(hello: Hello) -> Result<Hello, ControllerError> {
    if hello.magic == MAGIC && hello.protocol == PROTOCOL_VERSION {
        Ok(hello)
    } else {
        Err(ControllerError::Version { found: hello.protocol, expected: PROTOCOL_VERSION })
    }
}
