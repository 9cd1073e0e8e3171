//! The controller's own code in this process.

use super::{Controller, ControllerError, greeted};
use firmware::{Identity, NoTicks, Session};
use link::{
    BuildId, ClockSource, Configuration, Counters, EstimateFrame, Fault, Hello, SensorFrame, Target,
    ToController, ToHost,
};

/// The session of the firmware, without a link between.
#[derive(Debug)]
pub struct NativeController {
    session: Session,
    hello: Hello,
}

impl NativeController {
    /// Starts and configures a session.
    pub fn start(configuration: Configuration) -> Result<Self, ControllerError> {
        let build_id = BuildId::new(env!("CARGO_PKG_VERSION"));
        let identity = Identity { build_id, target: Target::Native, clock: ClockSource::Host, core_hz: 0 };
        let mut session = Session::new(identity);
        let hello = greeted(session.hello())?;
        match session.handle(&ToController::Configure(configuration), &mut NoTicks) {
            ToHost::Configured(_) => Ok(Self { session, hello }),
            ToHost::Fault(Fault::Refused(refusal)) => Err(ControllerError::Refused(refusal)),
            other => Err(unexpected(&other, "a configuration")),
        }
    }
}

fn unexpected(found: &ToHost, expected: &str) -> ControllerError {
    ControllerError::Unexpected { found: format!("{found:?}"), expected: expected.into() }
}

impl Controller for NativeController {
    fn name(&self) -> &'static str {
        "native"
    }

    fn hello(&self) -> &Hello {
        &self.hello
    }

    fn exchange(&mut self, frame: &SensorFrame) -> Result<EstimateFrame, ControllerError> {
        match self.session.handle(&ToController::Sensor(*frame), &mut NoTicks) {
            ToHost::Estimate(estimate) => Ok(estimate),
            other => Err(unexpected(&other, "an estimate")),
        }
    }

    fn finish(mut self: Box<Self>) -> Result<Counters, ControllerError> {
        match self.session.handle(&ToController::Stop, &mut NoTicks) {
            ToHost::Stopped(counters) => Ok(counters),
            other => Err(unexpected(&other, "the counters")),
        }
    }
}
