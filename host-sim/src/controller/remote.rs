//! A controller at the other end of two streams of bytes: pipes to the emulator, or a serial port.
//!
//! Every wait is bounded. A greeting or command that is not answered is sent again with the same number until the bound; a sample is not: its
//! estimate would come twice.

use super::{Controller, ControllerError, Conversation, Heard, Losses, greeted, stopped, unexpected};
use link::track::SensorStatus;
use link::update::{UpdateAnswer, UpdateRequest};
use link::{
    Answer, Command, ControllerConfiguration, Counters, Decoder, EstimateFrame, Hello, MAX_FRAME, Refused,
    SensorFrame, SlowFrame, ToController, ToHost, encode,
};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use std::collections::VecDeque;
use std::fs::File;
use std::io::{ErrorKind, Read, Write};
use std::process::Child;
use std::time::{Duration, Instant};

/// How often a silent controller is checked for being alive.
const CHECK: Duration = Duration::from_millis(100);

/// Bounds of the waits for a kind of line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    /// For an answer, s.
    pub(super) answer_s: u64,
    /// After which a greeting or a command is sent again.
    pub(super) again: Duration,
}

/// A running emulator and its folder; both go when this is dropped.
#[derive(Debug)]
pub(super) struct Process {
    pub(super) child: Child,
    pub(super) folder: tempfile::TempDir,
}

impl Drop for Process {
    fn drop(&mut self) {
        // Either it has ended already, or it must.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A controller that has greeted.
#[derive(Debug)]
pub struct RemoteController {
    name: &'static str,
    line: Line,
    conversation: Conversation,
    hello: Hello,
    slow: Option<SlowFrame>,
}

/// The streams and what has come through them.
#[derive(Debug)]
pub(super) struct Line {
    to_controller: File,
    to_host: File,
    process: Option<Process>,
    bounds: Bounds,
    decoder: Decoder,
    waiting: VecDeque<ToHost>,
    damaged: u32,
    last_sequence: Option<u32>,
}

impl RemoteController {
    /// Takes the greeting that the controller sends when it starts; `bound_s` is for that, `bounds` for everything later.
    pub(super) fn greeted(
        name: &'static str,
        mut line: Line,
        bound_s: u64,
        cause: &'static str,
    ) -> Result<Self, ControllerError> {
        let mut conversation = Conversation::new(0);
        let deadline = Instant::now() + Duration::from_secs(bound_s);
        let greeting = line.answer("its greeting", deadline, bound_s, cause)?;
        match conversation.hear(greeting) {
            Heard::Started(hello) => {
                Ok(Self { name, line, conversation, hello: greeted(hello)?, slow: None })
            }
            other => Err(unexpected(&other, "a greeting")),
        }
    }

    /// Asks a controller that may have been running for long who it is. `token` tells this asking from others'.
    pub(super) fn identified(name: &'static str, line: Line, token: u32) -> Result<Self, ControllerError> {
        let mut conversation = Conversation::new(token);
        let asking = conversation.identify();
        let mut controller = Self { name, line, conversation, hello: unknown(), slow: None };
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
        loop {
            match self.line.next("disturbed bytes", "The bytes may hold no end of a frame.")? {
                slow @ ToHost::Slow(_) => drop(self.take(slow)?),
                answer => return Ok(answer),
            }
        }
    }

    /// The emulator's process identifier, for tests that end it.
    pub fn process_id(&self) -> Option<u32> {
        self.line.process.as_ref().map(|process| process.child.id())
    }

    /// Sends a message that may be repeated and takes what answers it.
    fn ask(&mut self, message: &ToController, what: &'static str) -> Result<Heard, ControllerError> {
        let bound_s = self.line.bounds.answer_s;
        let deadline = Instant::now() + Duration::from_secs(bound_s);
        let mut message = *message;
        loop {
            self.line.send_message(&message)?;
            let until = (Instant::now() + self.line.bounds.again).min(deadline);
            loop {
                match self.line.answer(what, until, bound_s, OVERLOADED) {
                    Ok(answer) => match self.take(answer)? {
                        Some(Heard::Estimate(_) | Heard::Stray) | None => {}
                        Some(heard) => return Ok(heard),
                    },
                    Err(ControllerError::TimedOut { .. }) if until < deadline => break,
                    Err(error) => return Err(error),
                }
            }
            message = self.conversation.again().unwrap_or(message);
        }
    }

    /// Sorts a message; slow telemetry is kept.
    fn take(&mut self, message: ToHost) -> Result<Option<Heard>, ControllerError> {
        match self.conversation.hear(message) {
            Heard::Slow(slow) => {
                self.slow = Some(slow);
                Ok(None)
            }
            Heard::Started(hello) if self.hello.core_hz != 0 => {
                self.hello = hello;
                Err(ControllerError::Restarted { last_sequence: self.line.last_sequence })
            }
            heard => Ok(Some(heard)),
        }
    }
}

impl Controller for RemoteController {
    fn name(&self) -> &'static str {
        self.name
    }

    fn hello(&self) -> &Hello {
        &self.hello
    }

    fn exchange(&mut self, frame: &SensorFrame) -> Result<EstimateFrame, ControllerError> {
        self.line.send_message(&ToController::Sensor(*frame, SensorStatus::GOOD))?;
        loop {
            let message = self.line.next("a sample", OVERLOADED)?;
            match self.take(message)? {
                Some(Heard::Estimate(estimate)) if estimate.sequence == frame.sequence => {
                    self.line.last_sequence = Some(frame.sequence);
                    return Ok(estimate);
                }
                Some(other) => {
                    return Err(unexpected(&other, &format!("the estimate of sample {}", frame.sequence)));
                }
                None => {}
            }
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
                Heard::Outcome(outcome) => return outcome.map_err(ControllerError::Refused),
                other => return Err(unexpected(&other, "the answer to a command")),
            }
        }
        Err(ControllerError::Refused(Refused::NumberTaken))
    }

    fn heard(&self) -> (Option<SlowFrame>, Losses) {
        (self.slow, Losses { damaged: self.line.damaged, ..*self.conversation.losses() })
    }
}

/// Why an answer may be late.
const OVERLOADED: &str = "The firmware may hang, or the machine be overloaded.";

/// Stands for a greeting that has not come yet.
fn unknown() -> Hello {
    Hello {
        magic: [0; 4],
        protocol: 0,
        build_id: link::BuildId::new(""),
        target: link::Target::Silicon,
        clock: link::ClockSource::Internal,
        core_hz: 0,
        window: 0,
        models: [link::ModelId { crc: 0, training_id: 0 }; 2],
        token: 0,
        last_command: 0,
        state: link::State::Waiting,
        configuration_crc: 0,
        start: link::start::StartReport::default(),
        stack: link::start::StackReport::default(),
    }
}

impl Line {
    pub(super) fn new(to_controller: File, to_host: File, process: Option<Process>, bounds: Bounds) -> Self {
        let (decoder, waiting) = (Decoder::new(), VecDeque::new());
        Self { to_controller, to_host, process, bounds, decoder, waiting, damaged: 0, last_sequence: None }
    }

    fn send_message(&mut self, message: &ToController) -> Result<(), ControllerError> {
        let mut buffer = [0; MAX_FRAME];
        let frame = encode(message, &mut buffer).map_err(|e| ControllerError::Unexpected {
            found: e.to_string(),
            expected: "a message that fits a frame".into(),
        })?;
        self.send(frame)
    }

    /// A pipe holds hundreds of frames and lockstep has one on the way: a full pipe means that nobody reads.
    fn send(&mut self, bytes: &[u8]) -> Result<(), ControllerError> {
        match self.to_controller.write_all(bytes) {
            Ok(()) => Ok(()),
            Err(source) if source.kind() == ErrorKind::BrokenPipe => Err(self.ended()),
            Err(source) => Err(ControllerError::System { what: "writing to the controller", source }),
        }
    }

    /// The next message within the bound for answers.
    fn next(&mut self, waiting_for: &'static str, cause: &'static str) -> Result<ToHost, ControllerError> {
        let bound_s = self.bounds.answer_s;
        self.answer(waiting_for, Instant::now() + Duration::from_secs(bound_s), bound_s, cause)
    }

    fn answer(
        &mut self,
        waiting_for: &'static str,
        deadline: Instant,
        bound_s: u64,
        cause: &'static str,
    ) -> Result<ToHost, ControllerError> {
        let mut buffer = [0; 4 * MAX_FRAME];
        loop {
            if let Some(message) = self.waiting.pop_front() {
                return Ok(message);
            }
            match self.to_host.read(&mut buffer) {
                Ok(0) => self.check_alive()?,
                Ok(count) => {
                    self.decode(buffer.get(..count).unwrap_or_default())?;
                    continue;
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => {
                    if self.wait(deadline)? {
                        continue;
                    }
                    self.check_alive()?;
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(source) => {
                    return Err(ControllerError::System { what: "reading from the controller", source });
                }
            }
            if Instant::now() >= deadline {
                let last_sequence = self.last_sequence;
                return Err(ControllerError::TimedOut { waiting_for, bound_s, last_sequence, cause });
            }
        }
    }

    /// Pipes damage nothing, so a damaged frame there is an error; on a wire it is counted.
    fn decode(&mut self, bytes: &[u8]) -> Result<(), ControllerError> {
        for &byte in bytes {
            match self.decoder.push::<ToHost>(byte) {
                None => {}
                Some(Ok(message)) => self.waiting.push_back(message),
                Some(Err(error @ link::FrameError::OtherVersion { .. })) => {
                    return Err(ControllerError::Frame(error));
                }
                Some(Err(error)) if self.process.is_some() => return Err(ControllerError::Frame(error)),
                Some(Err(_)) => self.damaged = self.damaged.saturating_add(1),
            }
        }
        Ok(())
    }

    /// Waits a moment for bytes; false if none came.
    fn wait(&self, deadline: Instant) -> Result<bool, ControllerError> {
        let left = deadline.saturating_duration_since(Instant::now()).min(CHECK);
        let moment = Timespec { tv_sec: 0, tv_nsec: left.as_nanos() as i64 };
        let mut watched = [PollFd::new(&self.to_host, PollFlags::IN)];
        match poll(&mut watched, Some(&moment)) {
            Ok(ready) => Ok(ready > 0),
            Err(rustix::io::Errno::INTR) => Ok(true),
            Err(error) => {
                Err(ControllerError::System { what: "waiting for the controller", source: error.into() })
            }
        }
    }

    /// Nobody holds the other end: either the emulator has not opened it yet, or it has gone.
    fn check_alive(&mut self) -> Result<(), ControllerError> {
        let gone = match &mut self.process {
            Some(process) => !matches!(process.child.try_wait(), Ok(None)),
            None => false,
        };
        if gone {
            return Err(self.ended());
        }
        std::thread::sleep(Duration::from_millis(1));
        Ok(())
    }

    fn ended(&mut self) -> ControllerError {
        let (status, said) = match &mut self.process {
            None => ("the port is closed".into(), String::new()),
            Some(process) => {
                let status = match process.child.try_wait() {
                    Ok(Some(status)) => status.to_string(),
                    _ => "its end of the link is closed".into(),
                };
                let said = std::fs::read_to_string(process.folder.path().join("said")).unwrap_or_default();
                // After its reason the emulator may list every register.
                (status, said.trim().lines().next().unwrap_or_default().into())
            }
        };
        ControllerError::Ended { status, last_sequence: self.last_sequence, said }
    }
}
