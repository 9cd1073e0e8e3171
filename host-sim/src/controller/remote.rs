//! A controller at the other end of a line: the conversation with it.
//!
//! Every wait is bounded. A greeting or command that is not answered is sent again with the same number until the bound; a sample is only
//! sent again when the controller has said that it never came, because its estimate would come twice. A controller that owes an estimate
//! is asked how it is: that tells a restart whose greeting was lost, and an estimate that was lost, from silence.

use super::greeting::{greeted, unknown};
use super::line::{Line, Wait};
use super::{Controller, ControllerError, Conversation, Heard, Losses, Recorder, stopped, unexpected};
use link::track::SensorStatus;
use link::update::{UpdateAnswer, UpdateRequest};
use link::{
    Answer, Command, ControllerConfiguration, Counters, EstimateFrame, Hello, Refused, SensorFrame,
    SlowFrame, State, ToController, ToHost,
};
use std::time::{Duration, Instant};

/// A controller that has greeted.
#[derive(Debug)]
pub struct RemoteController {
    name: &'static str,
    line: Line,
    conversation: Conversation,
    hello: Hello,
    slow: Option<SlowFrame>,
    /// Estimates that this run has brought.
    answered: u32,
    /// An estimate that came while an answer was waited for.
    late: Option<EstimateFrame>,
}

impl RemoteController {
    fn new(name: &'static str, line: Line, conversation: Conversation, hello: Hello) -> Self {
        Self { name, line, conversation, hello, slow: None, answered: 0, late: None }
    }

    /// Takes the greeting that the controller sends when it starts; `bound` is for that, the line's bounds for everything later.
    pub(super) fn greeted(
        name: &'static str,
        mut line: Line,
        bound: Duration,
        cause: &'static str,
    ) -> Result<Self, ControllerError> {
        let mut conversation = Conversation::new(0);
        let greeting = line.answer(&Wait::of("its greeting", bound, cause))?;
        match conversation.hear(greeting) {
            Heard::Started(hello) => Ok(Self::new(name, line, conversation, greeted(hello)?)),
            other => Err(unexpected(&other, "a greeting")),
        }
    }

    /// Asks a controller that may have been running for long who it is. `token` tells this asking from others'.
    pub(super) fn identified(
        name: &'static str,
        mut line: Line,
        token: u32,
    ) -> Result<Self, ControllerError> {
        line.begin()?;
        let mut conversation = Conversation::new(token);
        let asking = conversation.identify();
        let mut controller = Self::new(name, line, conversation, unknown());
        match controller.ask(&asking, "its greeting")? {
            Heard::Greeting(hello) | Heard::Started(hello) => controller.hello = greeted(hello)?,
            other => return Err(unexpected(&other, "a greeting")),
        }
        Ok(controller)
    }

    /// Asks how things stand now.
    pub fn identify(&mut self) -> Result<Hello, ControllerError> {
        let asking = self.conversation.identify();
        match self.ask(&asking, "its greeting")? {
            Heard::Greeting(hello) => {
                self.hello = hello;
                Ok(hello)
            }
            other => Err(unexpected(&other, "a greeting")),
        }
    }

    /// Configures it.
    pub fn configure(&mut self, configuration: ControllerConfiguration) -> Result<(), ControllerError> {
        self.order(Command::Configure(configuration)).map(|_| ())
    }

    /// Asks about the models on board, or for an update of them. Such a request may be repeated, and is.
    pub fn update(&mut self, request: UpdateRequest) -> Result<UpdateAnswer, ControllerError> {
        match self.ask(&ToController::Update(request), "the models")? {
            Heard::Update(answer) => Ok(answer),
            other => Err(unexpected(&other, "an answer about models")),
        }
    }

    /// Sends raw bytes, as a disturbed line would, and returns the controller's answer.
    pub fn disturb(&mut self, bytes: &[u8]) -> Result<ToHost, ControllerError> {
        self.line.send(bytes)?;
        let wait =
            Wait::of("disturbed bytes", self.line.bounds.answer, "The bytes may hold no end of a frame.");
        loop {
            match self.line.answer(&wait)? {
                slow @ ToHost::Slow(_) => drop(self.take(slow)?),
                answer => return Ok(answer),
            }
        }
    }

    /// The emulator's process identifier, for tests that end it.
    pub fn process_id(&self) -> Option<u32> {
        self.line.process_id()
    }

    /// Sends a message that may be repeated and takes what answers it.
    fn ask(&mut self, message: &ToController, what: &'static str) -> Result<Heard, ControllerError> {
        let whole = Wait::of(what, self.line.bounds.answer, self.line.silence());
        let mut message = *message;
        loop {
            self.line.send_message(&message)?;
            let wait = Wait { until: self.next_try(&whole), ..whole };
            loop {
                match self.line.answer(&wait) {
                    Ok(answer) => match self.take(answer)? {
                        Some(Heard::Estimate(estimate)) => self.late = Some(estimate),
                        Some(Heard::Stray) | None => {}
                        // The line damaged what was sent; it is sent again.
                        Some(Heard::Fault(link::Fault::BadFrame(_))) if !self.line.is_lossless() => break,
                        Some(heard) => return Ok(heard),
                    },
                    Err(ControllerError::TimedOut { .. }) if wait.until < whole.until => break,
                    Err(error) => return Err(error),
                }
                // Whoever only talks of other things is as good as silent.
                self.line.check(&whole)?;
            }
            self.line.check(&whole)?;
            message = self.conversation.again().unwrap_or(message);
        }
    }

    fn next_try(&self, whole: &Wait) -> Instant {
        (Instant::now() + self.line.bounds.again).min(whole.until)
    }

    /// Sorts a message; slow telemetry is kept.
    fn take(&mut self, message: ToHost) -> Result<Option<Heard>, ControllerError> {
        match self.conversation.hear(message) {
            Heard::Slow(slow) => {
                self.slow = Some(slow);
                Ok(None)
            }
            Heard::Started(hello) if self.hello.core_hz != 0 => Err(self.restarted(hello)),
            heard => Ok(Some(heard)),
        }
    }

    fn restarted(&mut self, hello: Hello) -> ControllerError {
        self.hello = hello;
        ControllerError::Restarted { last_sequence: self.line.last_sequence, start: Box::new(hello.start) }
    }

    /// Waits for the estimate of a sample; none when the controller has said that the sample never came.
    fn estimate_of(
        &mut self,
        frame: &SensorFrame,
        whole: &Wait,
    ) -> Result<Option<EstimateFrame>, ControllerError> {
        loop {
            let wait = Wait { until: self.next_try(whole), ..*whole };
            match self.line.answer(&wait) {
                Ok(message) => match self.take(message)? {
                    Some(Heard::Estimate(estimate)) if belongs(&estimate, frame) => {
                        return Ok(Some(estimate));
                    }
                    // Of the run before this one.
                    Some(Heard::Estimate(_)) if self.answered == 0 && !self.line.is_lossless() => {}
                    Some(Heard::Stray) | None => {}
                    Some(Heard::Fault(link::Fault::BadFrame(_))) if !self.line.is_lossless() => {
                        return self.settle(frame);
                    }
                    Some(other) => {
                        return Err(unexpected(
                            &other,
                            &format!("the estimate of sample {}", frame.sequence),
                        ));
                    }
                },
                Err(ControllerError::TimedOut { .. }) if wait.until < whole.until => {
                    return self.settle(frame);
                }
                Err(error) => return Err(error),
            }
            self.line.check(whole)?;
        }
    }

    /// The estimate did not come. Asks whether the controller has started anew meanwhile, then whether it has taken the sample.
    fn settle(&mut self, frame: &SensorFrame) -> Result<Option<EstimateFrame>, ControllerError> {
        let expected = self.conversation.last_command();
        let now = match self.identify() {
            Err(ControllerError::TimedOut { bound_s, last_sequence, cause, .. }) => {
                return Err(ControllerError::TimedOut { waiting_for: SAMPLE, bound_s, last_sequence, cause });
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

/// Whether an estimate is that of a sample.
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
        let whole = Wait::of(SAMPLE, self.line.bounds.answer, self.line.silence());
        self.late = None;
        loop {
            self.line.send_message(&ToController::Sensor(*frame, status))?;
            if let Some(estimate) = self.estimate_of(frame, &whole)? {
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
        // Another host may have given a command since the greeting: then the number is taken, and asked for anew.
        for _ in 0..2 {
            let message = self.conversation.order(command);
            match self.ask(&message, "a command")? {
                Heard::Outcome(Err(Refused::OutOfOrder { .. } | Refused::NumberTaken)) => {
                    let asking = self.conversation.identify();
                    self.ask(&asking, "its greeting")?;
                }
                Heard::Outcome(outcome) => {
                    let answer = outcome.map_err(ControllerError::Refused)?;
                    if matches!(answer, Answer::Configured(_)) {
                        self.answered = 0;
                    }
                    return Ok(answer);
                }
                other => return Err(unexpected(&other, "the answer to a command")),
            }
        }
        Err(ControllerError::Refused(Refused::NumberTaken))
    }

    fn heard(&self) -> (Option<SlowFrame>, Losses) {
        (self.slow, Losses { damaged: self.line.damaged, ..*self.conversation.losses() })
    }
}

const SAMPLE: &str = "a sample";
