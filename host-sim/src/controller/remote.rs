//! A controller on a line, and the link session with it.
//!
//! Every wait has a timeout. A request or command without an answer is repeated with the same
//! number until the timeout. A sample is repeated only if the controller reports that it never
//! arrived, because otherwise its estimate would come twice. If an estimate is missing, the host
//! asks for the controller's state: this distinguishes a restart whose hello was lost, a lost
//! estimate, and a controller that does not answer.

use super::conversation::is_number_free;
use super::hello::{check_hello, no_hello};
use super::line::{Line, Wait};
use super::{Controller, ControllerError, Conversation, Losses, Received, Recorder, stopped, unexpected};
use link::authentication::LinkKey;
use link::track::SensorStatus;
use link::update::{UpdateAnswer, UpdateRequest};
use link::{
    Answer, Command, ControllerConfiguration, Counters, EstimateFrame, Hello, ImpactRecord, Refusal,
    SensorFrame, SlowFrame, State, ToController, ToHost,
};
use std::time::{Duration, Instant};

/// A controller that has completed the handshake.
#[derive(Debug)]
pub struct RemoteController {
    name: &'static str,
    line: Line,
    conversation: Conversation,
    hello: Hello,
    slow: Option<SlowFrame>,
    /// Estimates received in this run.
    answered: u32,
    /// An estimate that arrived while the host waited for another answer.
    late: Option<EstimateFrame>,
    impacts: Vec<ImpactRecord>,
    /// Largest force of all blocks since it was taken, N, and the flags of all their estimates.
    blocks: Option<(f32, u32)>,
}

impl RemoteController {
    fn new(name: &'static str, line: Line, conversation: Conversation, hello: Hello) -> Self {
        Self {
            name,
            line,
            conversation,
            hello,
            slow: None,
            answered: 0,
            late: None,
            impacts: Vec::new(),
            blocks: None,
        }
    }

    /// Waits for the hello that the controller sends when it starts. `timeout` applies to this wait
    /// only.
    pub(super) fn await_hello(
        name: &'static str,
        mut line: Line,
        timeout: Duration,
        cause: &'static str,
    ) -> Result<Self, ControllerError> {
        let mut conversation = Conversation::new(0);
        let hello = line.answer(&Wait::new("its hello", timeout, cause))?;
        match conversation.receive(hello) {
            Received::Started(hello) => Ok(Self::new(name, line, conversation, check_hello(hello)?)),
            other => Err(unexpected(&other, "a hello")),
        }
    }

    /// Identifies a controller that may have been running before. `token` distinguishes this
    /// request from those of other hosts.
    pub(super) fn handshake(name: &'static str, mut line: Line, token: u32) -> Result<Self, ControllerError> {
        line.begin()?;
        let mut conversation = Conversation::new(token);
        let asking = conversation.identify();
        let mut controller = Self::new(name, line, conversation, no_hello());
        match controller.ask(&asking, "its hello")? {
            Received::Identified(hello) => controller.hello = check_hello(hello)?,
            other => return Err(unexpected(&other, "a hello")),
        }
        Ok(controller)
    }

    /// Asks for a new hello.
    pub fn identify(&mut self) -> Result<Hello, ControllerError> {
        let asking = self.conversation.identify();
        match self.ask(&asking, "its hello")? {
            Received::Identified(hello) => {
                self.hello = hello;
                Ok(hello)
            }
            other => Err(unexpected(&other, "a hello")),
        }
    }

    /// Sets the key that authenticates commands; a controller without a key ignores it.
    #[must_use]
    pub const fn with_key(mut self, key: Option<LinkKey>) -> Self {
        self.conversation.set_key(key);
        self
    }

    /// Sends a configuration.
    pub fn configure(&mut self, configuration: ControllerConfiguration) -> Result<(), ControllerError> {
        self.order(Command::Configure(configuration)).map(|_| ())
    }

    /// Sends a request about the models on board. Such requests may be repeated. An update with a
    /// package is permitted before, if the controller requires a key.
    pub fn update(&mut self, request: UpdateRequest) -> Result<UpdateAnswer, ControllerError> {
        if let UpdateRequest::Begin(package) = &request
            && self.conversation.is_key_required()
        {
            self.order(Command::PermitUpdate(package.hash()))?;
        }
        let asking = self.conversation.request(request);
        match self.ask(&asking, "the models")? {
            Received::Update(answer) => Ok(answer),
            other => Err(unexpected(&other, "an answer about models")),
        }
    }

    /// Sends raw bytes, as a disturbed line would, and returns the controller's answer.
    pub fn disturb(&mut self, bytes: &[u8]) -> Result<ToHost, ControllerError> {
        self.line.send(bytes)?;
        let wait =
            Wait::new("disturbed bytes", self.line.timeouts.answer, "The bytes may hold no end of a frame.");
        loop {
            match self.line.answer(&wait)? {
                other @ (ToHost::Slow(_) | ToHost::Impact(_) | ToHost::Block(_)) => drop(self.take(other)?),
                answer => return Ok(answer),
            }
        }
    }

    /// Process identifier of the emulator, for tests that end it.
    pub fn process_id(&self) -> Option<u32> {
        self.line.process_id()
    }

    /// Sends a message that may be repeated, and returns its answer.
    fn ask(&mut self, message: &ToController, what: &'static str) -> Result<Received, ControllerError> {
        let deadline = Wait::new(what, self.line.timeouts.answer, self.line.silence());
        let mut message = *message;
        loop {
            self.line.send_message(&message)?;
            let wait = Wait { until: self.next_try(&deadline), ..deadline };
            loop {
                match self.line.answer(&wait) {
                    Ok(answer) => match self.take(answer)? {
                        Some(Received::Estimate(estimate)) => self.late = Some(estimate),
                        Some(Received::Stray) | None => {}
                        // The controller has just started. The answer to this request is still to
                        // come; left on the line, it would appear in the next recording.
                        Some(Received::Started(_)) if matches!(message, ToController::Identify { .. }) => {}
                        // The line damaged the request: repeat it.
                        Some(Received::Fault(link::Fault::BadFrame(_))) if !self.line.is_lossless() => break,
                        Some(heard) => return Ok(heard),
                    },
                    Err(ControllerError::TimedOut { .. }) if wait.until < deadline.until => break,
                    Err(error) => return Err(error),
                }
                // Other messages do not extend the wait.
                self.line.check(&deadline)?;
            }
            self.line.check(&deadline)?;
            message = self.conversation.repeat().unwrap_or(message);
        }
    }

    fn next_try(&self, deadline: &Wait) -> Instant {
        (Instant::now() + self.line.timeouts.retry).min(deadline.until)
    }

    /// Takes the largest force in N and the flags of all estimates since the last call, those that
    /// were not sent included; none if no block has arrived.
    pub(crate) const fn take_blocks(&mut self) -> Option<(f32, u32)> {
        self.blocks.take()
    }

    /// Classifies a message and stores slow telemetry, impacts and blocks.
    fn take(&mut self, message: ToHost) -> Result<Option<Received>, ControllerError> {
        match self.conversation.receive(message) {
            Received::Slow(slow) => {
                self.slow = Some(slow);
                Ok(None)
            }
            Received::Block(block) => {
                let (largest_n, flags) = self.blocks.unwrap_or_default();
                self.blocks = Some((largest_n.max(block.max_force_n), flags | block.flags));
                Ok(None)
            }
            Received::Impact(impact) => {
                self.impacts.push(impact);
                Ok(None)
            }
            Received::Started(hello) if self.hello.core_hz != 0 => Err(self.restarted(hello)),
            heard => Ok(Some(heard)),
        }
    }

    fn restarted(&mut self, hello: Hello) -> ControllerError {
        self.hello = hello;
        ControllerError::Restarted { last_sequence: self.line.last_sequence, start: Box::new(hello.start) }
    }

    /// Waits for the estimate of a sample. Returns none if the controller reports that the sample
    /// never arrived.
    fn estimate_of(
        &mut self,
        frame: &SensorFrame,
        deadline: &Wait,
    ) -> Result<Option<EstimateFrame>, ControllerError> {
        loop {
            let wait = Wait { until: self.next_try(deadline), ..*deadline };
            match self.line.answer(&wait) {
                Ok(message) => match self.take(message)? {
                    Some(Received::Estimate(estimate)) if belongs(&estimate, frame) => {
                        return Ok(Some(estimate));
                    }
                    // An estimate of the previous run.
                    Some(Received::Estimate(_)) if self.answered == 0 && !self.line.is_lossless() => {}
                    Some(Received::Stray) | None => {}
                    Some(Received::Fault(link::Fault::BadFrame(_))) if !self.line.is_lossless() => {
                        return self.settle(frame);
                    }
                    Some(other) => {
                        return Err(unexpected(
                            &other,
                            &format!("the estimate of sample {}", frame.sequence),
                        ));
                    }
                },
                Err(ControllerError::TimedOut { .. }) if wait.until < deadline.until => {
                    return self.settle(frame);
                }
                Err(error) => return Err(error),
            }
            self.line.check(deadline)?;
        }
    }

    /// Resolves a missing estimate: asks whether the controller has restarted, then whether it has
    /// received the sample.
    fn settle(&mut self, frame: &SensorFrame) -> Result<Option<EstimateFrame>, ControllerError> {
        let expected = self.conversation.last_command();
        let now = match self.identify() {
            Err(ControllerError::TimedOut { timeout_s, last_sequence, cause, .. }) => {
                return Err(ControllerError::TimedOut {
                    waiting_for: SAMPLE,
                    timeout_s,
                    last_sequence,
                    cause,
                });
            }
            other => other?,
        };
        if now.last_command != expected || now.state == State::Waiting {
            return Err(self.restarted(now));
        }
        let samples = match self.order(Command::GetCounters)? {
            Answer::Counters(counters) => counters.samples,
            other => return Err(unexpected(&other, "the counters")),
        };
        match self.late.take() {
            Some(estimate) if belongs(&estimate, frame) => Ok(Some(estimate)),
            _ if samples == self.answered => Ok(None),
            _ => Err(ControllerError::Lost {
                sequence: frame.sequence,
                last_sequence: self.line.last_sequence,
                damaged: self.line.damaged,
            }),
        }
    }
}

/// Decides whether an estimate belongs to a sample.
const fn belongs(estimate: &EstimateFrame, frame: &SensorFrame) -> bool {
    estimate.sequence == frame.sequence && estimate.time_us == frame.time_us
}

impl Controller for RemoteController {
    fn name(&self) -> &'static str {
        self.name
    }

    fn hello(&self) -> &Hello {
        &self.hello
    }

    fn listen(&mut self, recorder: Recorder) {
        self.line.recorder = Some(recorder);
    }

    fn sample(
        &mut self,
        frame: &SensorFrame,
        status: SensorStatus,
    ) -> Result<EstimateFrame, ControllerError> {
        let deadline = Wait::new(SAMPLE, self.line.timeouts.answer, self.line.silence());
        self.late = None;
        loop {
            self.line.send_message(&ToController::Sensor(*frame, status))?;
            if let Some(estimate) = self.estimate_of(frame, &deadline)? {
                self.line.last_sequence = Some(frame.sequence);
                self.answered = self.answered.saturating_add(1);
                return Ok(estimate);
            }
            self.conversation.count_repeated();
        }
    }

    fn finish(mut self: Box<Self>) -> Result<Counters, ControllerError> {
        stopped(self.order(Command::Stop)?)
    }

    fn order(&mut self, command: Command) -> Result<Answer, ControllerError> {
        // Another host may have sent a command since the hello. Then the number is taken, and the
        // host asks for the next one. After an unnoticed restart the tag needs the new start's
        // number.
        let mut refused = Refusal::NumberTaken;
        for _ in 0..2 {
            if command.changes_state() && self.conversation.has_wrong_key() {
                return Err(ControllerError::WrongKey);
            }
            if command.changes_state() && self.conversation.has_needless_key() {
                return Err(ControllerError::NeedlessKey);
            }
            let message = self.conversation.order(command);
            match self.ask(&message, "a command")? {
                Received::Outcome(Err(refusal)) if is_number_free(&refusal) => {
                    refused = refusal;
                    let asking = self.conversation.identify();
                    self.ask(&asking, "its hello")?;
                }
                Received::Outcome(outcome) => {
                    let answer = outcome.map_err(ControllerError::Refused)?;
                    if matches!(answer, Answer::Configured(_)) {
                        self.answered = 0;
                    }
                    return Ok(answer);
                }
                other => return Err(unexpected(&other, "the answer to a command")),
            }
        }
        Err(ControllerError::Refused(refused))
    }

    fn take_impacts(&mut self) -> Vec<ImpactRecord> {
        std::mem::take(&mut self.impacts)
    }

    fn link_state(&self) -> (Option<SlowFrame>, Losses) {
        (self.slow, Losses { damaged: self.line.damaged, ..*self.conversation.losses() })
    }
}

const SAMPLE: &str = "a sample";

#[cfg(test)]
mod tests;
