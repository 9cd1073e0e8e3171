//! A stream of bytes with a controller at the other end: pipes to the emulator, a serial port, or a debug probe.
//!
//! Every wait is bounded, writing included, and an error says what the last sample was that the controller answered.

use super::one_core::OneCore;
use super::stream::Stream;
use super::{ControllerError, Recorder, framed, system};
use link::{DELIMITER, Decoder, MAX_FRAME, ToController, ToHost};
use rustix::event::PollFlags;
use std::collections::VecDeque;
use std::io::{Error, ErrorKind};
use std::process::Child;
use std::time::{Duration, Instant};

/// How often a silent controller is checked for being alive.
const CHECK: Duration = Duration::from_millis(100);

/// Bounds of the waits for a kind of line.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    /// For an answer.
    pub answer: Duration,
    /// After which a greeting or a command is sent again, and whoever owes an estimate is asked how it is.
    pub again: Duration,
}

/// A running emulator and its folder; both go when this is dropped.
#[derive(Debug)]
pub(super) struct Process {
    pub(super) child: Child,
    pub(super) folder: tempfile::TempDir,
    pub(super) _core: Option<OneCore>,
}

impl Drop for Process {
    fn drop(&mut self) {
        // Either it has ended already, or it must.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// What is waited for and how long; for the error.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wait {
    pub(super) what: &'static str,
    pub(super) until: Instant,
    pub(super) bound: Duration,
    pub(super) cause: &'static str,
}

impl Wait {
    /// For all of a bound from now on.
    pub(super) fn of(what: &'static str, bound: Duration, cause: &'static str) -> Self {
        Self { what, until: Instant::now() + bound, bound, cause }
    }
}

/// The stream and what has come through it.
#[derive(Debug)]
pub(super) struct Line {
    stream: Stream,
    process: Option<Process>,
    decoder: Decoder,
    waiting: VecDeque<ToHost>,
    pub(super) bounds: Bounds,
    pub(super) damaged: u32,
    /// The last sample that was answered.
    pub(super) last_sequence: Option<u32>,
    pub(super) recorder: Option<Recorder>,
}

impl Line {
    pub(super) fn new(stream: Stream, process: Option<Process>, bounds: Bounds) -> Self {
        Self {
            stream,
            process,
            decoder: Decoder::new(),
            waiting: VecDeque::new(),
            bounds,
            damaged: 0,
            last_sequence: None,
            recorder: None,
        }
    }

    /// Whether what is sent arrives, and undamaged: pipes, not wires.
    pub(super) const fn is_lossless(&self) -> bool {
        self.process.is_some()
    }

    pub(super) fn process_id(&self) -> Option<u32> {
        self.process.as_ref().map(|process| process.child.id())
    }

    /// Ends whatever the last host left unfinished on the line. On an idle line this is nothing.
    pub(super) fn begin(&mut self) -> Result<(), ControllerError> {
        self.send(&[DELIMITER])
    }

    pub(super) fn send_message(&mut self, message: &ToController) -> Result<(), ControllerError> {
        let mut buffer = [0; MAX_FRAME];
        if let Some(recorder) = &self.recorder {
            recorder.sent(message)?;
        }
        self.send(framed(message, &mut buffer)?)
    }

    /// Lockstep has one frame on the way, and a pipe or a port holds many: a full one means that nobody reads.
    pub(super) fn send(&mut self, mut bytes: &[u8]) -> Result<(), ControllerError> {
        let wait = Wait::of("bytes that the line should take", self.bounds.answer, self.stream.words().full);
        while !bytes.is_empty() {
            match self.stream.write(bytes) {
                Ok(count) => bytes = bytes.get(count..).unwrap_or_default(),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) if error.kind() == ErrorKind::WouldBlock => {
                    self.poll(PollFlags::OUT, wait.until)?;
                    self.check_process()?;
                    self.check(&wait)?;
                }
                Err(error) if error.kind() == ErrorKind::BrokenPipe => return Err(self.ended(None)),
                Err(error) => return Err(self.failed("writing to the controller", error)),
            }
        }
        Ok(())
    }

    /// The next message.
    pub(super) fn answer(&mut self, wait: &Wait) -> Result<ToHost, ControllerError> {
        let mut buffer = [0; 4 * MAX_FRAME];
        loop {
            if let Some(message) = self.waiting.pop_front() {
                if let Some(recorder) = &self.recorder {
                    recorder.received(&message)?;
                }
                return Ok(message);
            }
            match self.stream.read(&mut buffer) {
                // Nobody holds the other end of a pipe: the emulator has not opened it yet, or has gone.
                Ok(0) if self.is_lossless() => {
                    self.check_process()?;
                    std::thread::sleep(Duration::from_millis(1));
                }
                Ok(0) => return Err(self.ended(None)),
                Ok(count) => {
                    self.decode(buffer.get(..count).unwrap_or_default())?;
                    continue;
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => {
                    if self.poll(PollFlags::IN, wait.until)? {
                        continue;
                    }
                    self.check_process()?;
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(self.failed("reading from the controller", error)),
            }
            self.check(wait)?;
        }
    }

    /// Whether there is time left.
    pub(super) fn check(&self, wait: &Wait) -> Result<(), ControllerError> {
        if Instant::now() < wait.until {
            return Ok(());
        }
        Err(ControllerError::TimedOut {
            waiting_for: wait.what,
            bound_s: wait.bound.as_secs_f64().ceil() as u64,
            last_sequence: self.last_sequence,
            cause: wait.cause,
        })
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
                Some(Err(error)) if self.is_lossless() => return Err(ControllerError::Frame(error)),
                Some(Err(_)) => self.damaged = self.damaged.saturating_add(1),
            }
        }
        Ok(())
    }

    /// Waits a moment for the stream to be ready; false if it is not.
    fn poll(&self, for_what: PollFlags, until: Instant) -> Result<bool, ControllerError> {
        let left = until.saturating_duration_since(Instant::now()).min(CHECK);
        self.stream.ready(for_what, left).map_err(system("waiting for the controller"))
    }

    /// Why an answer may be late.
    pub(super) const fn silence(&self) -> &'static str {
        if self.is_lossless() { OVERLOADED } else { self.stream.words().silent }
    }

    fn check_process(&mut self) -> Result<(), ControllerError> {
        let gone = match &mut self.process {
            Some(process) => !matches!(process.child.try_wait(), Ok(None)),
            None => false,
        };
        if gone { Err(self.ended(None)) } else { Ok(()) }
    }

    /// An error of a port is mostly its end: the adapter was unplugged, the other side of a pseudo-terminal has gone.
    fn failed(&mut self, what: &'static str, source: Error) -> ControllerError {
        if self.is_lossless() { ControllerError::System { what, source } } else { self.ended(Some(&source)) }
    }

    fn ended(&mut self, error: Option<&Error>) -> ControllerError {
        let (status, said) = match &mut self.process {
            None => {
                let told = error.map(|error| format!(": {error}")).unwrap_or_default();
                let words = self.stream.words();
                (format!("{}{told}", words.end), words.gone.into())
            }
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

const OVERLOADED: &str = "The firmware may hang, or the machine be overloaded.";
