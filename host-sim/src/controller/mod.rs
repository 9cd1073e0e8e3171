//! The controller's ends: the same conversation in this process and with the emulated controller.
//!
//! Lockstep: the sensor frame's time is the controller's time, and the host waits for the estimate of every frame. Every
//! wait is bounded and names what it waited for. A restarted controller is noticed by its unasked greeting.

mod emulated;
mod error;
mod native;

pub use emulated::EmulatedController;
pub use error::ControllerError;
pub use native::NativeController;

use link::{Counters, EstimateFrame, Hello, MAGIC, PROTOCOL_VERSION, SensorFrame};

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
}

/// Accepts a greeting of this protocol only.
fn greeted(hello: Hello) -> Result<Hello, ControllerError> {
    if hello.magic == MAGIC && hello.protocol == PROTOCOL_VERSION {
        Ok(hello)
    } else {
        Err(ControllerError::Version { found: hello.protocol, expected: PROTOCOL_VERSION })
    }
}
