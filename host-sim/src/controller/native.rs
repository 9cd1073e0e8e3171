//! The controller's own code in this process.

use super::{Controller, ControllerError, Conversation, Heard, Losses, greeted, stopped, unexpected};
use firmware::{Identity, NoTicks, Session};
use link::track::SensorStatus;
use link::{
    Answer, BuildId, ClockSource, Command, ControllerConfiguration, Counters, EstimateFrame, Hello,
    SensorFrame, SlowFrame, Target, ToController, ToHost,
};

/// The session of the firmware, without a line between.
#[derive(Debug)]
pub struct NativeController {
    session: Session,
    conversation: Conversation,
    hello: Hello,
    slow: Option<SlowFrame>,
}

impl NativeController {
    /// Starts and configures a session.
    pub fn start(configuration: ControllerConfiguration) -> Result<Self, ControllerError> {
        let build_id = BuildId::new(env!("CARGO_PKG_VERSION"));
        let identity = Identity { build_id, target: Target::Native, clock: ClockSource::Host, core_hz: 0 };
        let session = Session::new(identity);
        let hello = greeted(session.hello(0))?;
        let mut conversation = Conversation::default();
        conversation.hear(ToHost::Hello(hello));
        let mut controller = Self { session, conversation, hello, slow: None };
        controller.order(Command::Configure(configuration))?;
        Ok(controller)
    }

    fn exchange_message(&mut self, message: &ToController) -> Heard {
        let answer = self.session.handle(message, &mut NoTicks);
        self.conversation.hear(answer)
    }
}

impl Controller for NativeController {
    fn name(&self) -> &'static str {
        "native"
    }

    fn hello(&self) -> &Hello {
        &self.hello
    }

    fn exchange(&mut self, frame: &SensorFrame) -> Result<EstimateFrame, ControllerError> {
        let heard = self.exchange_message(&ToController::Sensor(*frame, SensorStatus::GOOD));
        if let Some(ToHost::Slow(slow)) = self.session.slow() {
            self.conversation.hear(ToHost::Slow(slow));
            self.slow = Some(slow);
        }
        match heard {
            Heard::Estimate(estimate) => Ok(estimate),
            other => Err(unexpected(&other, "an estimate")),
        }
    }

    fn finish(mut self: Box<Self>) -> Result<Counters, ControllerError> {
        stopped(self.order(Command::Stop)?)
    }

    fn order(&mut self, command: Command) -> Result<Answer, ControllerError> {
        let message = self.conversation.order(command);
        match self.exchange_message(&message) {
            Heard::Outcome(outcome) => outcome.map_err(ControllerError::Refused),
            other => Err(unexpected(&other, "the answer to a command")),
        }
    }

    fn heard(&self) -> (Option<SlowFrame>, Losses) {
        (self.slow, *self.conversation.losses())
    }
}
