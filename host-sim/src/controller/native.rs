//! The controller's own code in this process.

use super::hello::check_hello;
use super::{Controller, ControllerError, Conversation, Losses, Received, Recorder, stopped, unexpected};
use controller::{Identity, NoTicks, Session};
use link::track::SensorStatus;
use link::{
    Answer, BuildId, ClockSource, Command, ControllerConfiguration, Counters, EstimateFrame, Hello,
    ImpactRecord, SensorFrame, SlowFrame, Target, ToController, ToHost,
};

/// The firmware's session, called directly.
#[derive(Debug)]
pub struct NativeController {
    session: Session,
    conversation: Conversation,
    hello: Hello,
    slow: Option<SlowFrame>,
    impacts: Vec<ImpactRecord>,
    recorder: Option<Recorder>,
}

impl NativeController {
    /// Starts and configures a session.
    pub fn start(configuration: ControllerConfiguration) -> Result<Self, ControllerError> {
        let mut controller = Self::open()?;
        controller.order(Command::Configure(configuration))?;
        Ok(controller)
    }

    /// Starts a session.
    pub fn open() -> Result<Self, ControllerError> {
        let build_id = BuildId::new(env!("CARGO_PKG_VERSION"));
        let identity = Identity { build_id, target: Target::Native, clock: ClockSource::Host, core_hz: 0 };
        let session = Session::new(identity);
        let hello = check_hello(session.hello(0))?;
        let mut conversation = Conversation::default();
        conversation.receive(ToHost::Hello(hello));
        Ok(Self { session, conversation, hello, slow: None, impacts: Vec::new(), recorder: None })
    }

    fn exchange_message(&mut self, message: &ToController) -> Result<Received, ControllerError> {
        let answer = self.session.handle(message, &mut NoTicks);
        if let Some(recorder) = &self.recorder {
            recorder.sent(message)?;
            recorder.received(&answer)?;
        }
        let received = self.conversation.receive(answer);
        self.receive_impacts()?;
        Ok(received)
    }

    fn receive_impacts(&mut self) -> Result<(), ControllerError> {
        while let Some(message) = self.session.take_impact() {
            if let Some(recorder) = &self.recorder {
                recorder.received(&message)?;
            }
            if let Received::Impact(impact) = self.conversation.receive(message) {
                self.impacts.push(impact);
            }
        }
        Ok(())
    }
}

impl Controller for NativeController {
    fn name(&self) -> &'static str {
        "native"
    }

    fn hello(&self) -> &Hello {
        &self.hello
    }

    fn listen(&mut self, recorder: Recorder) {
        self.recorder = Some(recorder);
    }

    fn sample(
        &mut self,
        frame: &SensorFrame,
        status: SensorStatus,
    ) -> Result<EstimateFrame, ControllerError> {
        let received = self.exchange_message(&ToController::Sensor(*frame, status))?;
        if let Some(message @ ToHost::Slow(slow)) = self.session.take_telemetry() {
            if let Some(recorder) = &self.recorder {
                recorder.received(&message)?;
            }
            self.conversation.receive(message);
            self.slow = Some(slow);
        }
        match received {
            Received::Estimate(estimate) => Ok(estimate),
            other => Err(unexpected(&other, "an estimate")),
        }
    }

    fn finish(mut self: Box<Self>) -> Result<Counters, ControllerError> {
        stopped(self.order(Command::Stop)?)
    }

    fn order(&mut self, command: Command) -> Result<Answer, ControllerError> {
        let message = self.conversation.order(command);
        match self.exchange_message(&message)? {
            Received::Outcome(outcome) => outcome.map_err(ControllerError::Refused),
            other => Err(unexpected(&other, "the answer to a command")),
        }
    }

    fn take_impacts(&mut self) -> Vec<ImpactRecord> {
        std::mem::take(&mut self.impacts)
    }

    fn link_state(&self) -> (Option<SlowFrame>, Losses) {
        (self.slow, *self.conversation.losses())
    }
}
