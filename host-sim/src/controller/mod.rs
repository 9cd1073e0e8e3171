//! One trait for all controllers: in this process, emulated, on a serial port, or at a debug probe.
//!
//! Lockstep: the sensor frame's time is the controller's time, and the host waits for the estimate
//! of every frame. Every wait has a timeout and names what it waited for. A restart is recognised
//! by an unrequested hello or, if that was lost, by the number of the last command. A [`Recorder`]
//! receives every frame in both directions.

mod attached;
pub mod choice;
mod conversation;
mod emulated;
mod error;
mod hello;
mod line;
mod native;
mod one_core;
#[cfg(feature = "probe")]
mod probe;
#[cfg(feature = "probe")]
mod probe_channels;
mod recorder;
pub mod recording;
mod remote;
mod stream;

pub use attached::{AttachedController, TIMEOUTS};
pub use conversation::{Conversation, Losses, Received};
pub use emulated::EmulatedController;
pub use error::ControllerError;
pub use line::Timeouts;
pub use native::NativeController;
#[cfg(feature = "probe")]
pub use probe::ProbedController;
use recorder::framed;
pub use recorder::{Direction, RecordedFrame, Recorder};
pub use recording::Recording;
pub use remote::RemoteController;

use error::{system, unexpected};
use link::track::SensorStatus;
use link::{Answer, Command, Counters, EstimateFrame, Hello, ImpactRecord, SensorFrame, SlowFrame};

/// A configured controller.
pub trait Controller {
    /// Transport in one word: `native`, `emulated` or `attached`.
    fn name(&self) -> &'static str;
    /// Its last hello.
    fn hello(&self) -> &Hello;
    /// Records every frame from now on.
    fn listen(&mut self, recorder: Recorder);
    /// Sends a sample with the status of its channels and returns the estimate.
    fn sample(&mut self, frame: &SensorFrame, status: SensorStatus)
    -> Result<EstimateFrame, ControllerError>;
    /// Sends a sample with all channels good and returns the estimate.
    fn exchange(&mut self, frame: &SensorFrame) -> Result<EstimateFrame, ControllerError> {
        self.sample(frame, SensorStatus::GOOD)
    }
    /// Ends the run and returns its counters.
    fn finish(self: Box<Self>) -> Result<Counters, ControllerError>;
    /// Sends a command and returns the answer.
    fn order(&mut self, command: Command) -> Result<Answer, ControllerError>;
    /// Takes the impacts that have been received since the last call.
    fn take_impacts(&mut self) -> Vec<ImpactRecord>;
    /// Last frame of slow telemetry, and the losses on the link.
    fn link_state(&self) -> (Option<SlowFrame>, Losses);
}

/// Extracts the counters from the answer to a stop command.
pub(crate) fn stopped(answer: Answer) -> Result<Counters, ControllerError> {
    match answer {
        Answer::Stopped(counters) => Ok(counters),
        other => Err(unexpected(&other, "the counters")),
    }
}
