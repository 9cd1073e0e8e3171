//! A byte stream to a controller: pipes to the emulator, a serial port, or a debug probe.
//!
//! Every wait has a timeout, also for writing. Errors name the last sample that the controller
//! answered.

use super::one_core::OneCore;
use super::stream::Stream;
use super::{ControllerError, Recorder, framed, system};
use link::{DELIMITER, Decoder, MAX_FRAME, ToController, ToHost};
use rustix::event::PollFlags;
use std::collections::VecDeque;
use std::io::{Error, ErrorKind};
use std::process::Child;
use std::time::{Duration, Instant};

/// Interval at which a silent emulator is checked for being alive.
const CHECK: Duration = Duration::from_millis(100);

/// Timeouts of a line.
#[derive(Clone, Copy, Debug)]
pub struct Timeouts {
    /// Timeout of an answer.
    pub answer: Duration,
    /// Time after which a request is repeated, or the host asks for the state of a controller whose
    /// estimate is missing.
    pub retry: Duration,
}

/// A running emulator and its folder. Dropping it ends the process and deletes the folder.
#[derive(Debug)]
pub(super) struct Process {
    pub(super) child: Child,
    pub(super) folder: tempfile::TempDir,
    pub(super) _core: Option<OneCore>,
}

impl Drop for Process {
    fn drop(&mut self) {
        // The process has ended already, or has to end now.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A timeout with what is awaited, for the error message.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wait {
    pub(super) what: &'static str,
    pub(super) until: Instant,
    pub(super) timeout: Duration,
    pub(super) cause: &'static str,
}

impl Wait {
    /// Creates a timeout that starts now.
    pub(super) fn new(what: &'static str, timeout: Duration, cause: &'static str) -> Self {
        Self { what, until: Instant::now() + timeout, timeout, cause }
    }
}

/// The stream, its decoder and the messages that were received but not yet taken.
#[derive(Debug)]
pub(super) struct Line {
    stream: Stream,
    process: Option<Process>,
    decoder: Decoder,
    waiting: VecDeque<ToHost>,
    pub(super) timeouts: Timeouts,
    pub(super) damaged: u32,
    /// Sequence number of the last answered sample.
    pub(super) last_sequence: Option<u32>,
    pub(super) recorder: Option<Recorder>,
}

impl Line {
    pub(super) fn new(stream: Stream, process: Option<Process>, timeouts: Timeouts) -> Self {
        Self {
            stream,
            process,
            decoder: Decoder::new(),
            waiting: VecDeque::new(),
            timeouts,
            damaged: 0,
            last_sequence: None,
            recorder: None,
        }
    }

    /// Returns whether everything that is sent arrives undamaged: true for pipes, false for wires.
    pub(super) const fn is_lossless(&self) -> bool {
        self.process.is_some()
    }

    pub(super) fn process_id(&self) -> Option<u32> {
        self.process.as_ref().map(|process| process.child.id())
    }

    /// Ends an incomplete frame that the last host may have left. On an idle line this has no
    /// effect.
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

    /// Sends bytes. In lockstep one frame is on the line and a pipe or port holds many, so a full
    /// one means that nothing reads.
    pub(super) fn send(&mut self, mut bytes: &[u8]) -> Result<(), ControllerError> {
        let wait =
            Wait::new("bytes that the line should take", self.timeouts.answer, self.stream.messages().full);
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

    /// Returns the next message.
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
                // No writer on the pipe: the emulator has not opened it yet, or has ended.
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

    /// Fails if the timeout has passed.
    pub(super) fn check(&self, wait: &Wait) -> Result<(), ControllerError> {
        if Instant::now() < wait.until {
            return Ok(());
        }
        Err(ControllerError::TimedOut {
            waiting_for: wait.what,
            timeout_s: wait.timeout.as_secs_f64().ceil() as u64,
            last_sequence: self.last_sequence,
            cause: wait.cause,
        })
    }

    /// Decodes bytes. Pipes damage nothing, so a damaged frame there is an error; on a wire it is
    /// counted.
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

    /// Waits briefly for the stream to be ready. Returns false if it is not.
    fn poll(&self, for_what: PollFlags, until: Instant) -> Result<bool, ControllerError> {
        let left = until.saturating_duration_since(Instant::now()).min(CHECK);
        self.stream.ready(for_what, left).map_err(system("waiting for the controller"))
    }

    /// Likely cause of a late answer.
    pub(super) const fn silence(&self) -> &'static str {
        if self.is_lossless() { OVERLOADED } else { self.stream.messages().silent }
    }

    fn check_process(&mut self) -> Result<(), ControllerError> {
        let gone = match &mut self.process {
            Some(process) => !matches!(process.child.try_wait(), Ok(None)),
            None => false,
        };
        if gone { Err(self.ended(None)) } else { Ok(()) }
    }

    /// Converts an error of the stream. An error of a port mostly means that its other side has
    /// ended or was unplugged.
    fn failed(&mut self, what: &'static str, source: Error) -> ControllerError {
        if self.is_lossless() { ControllerError::System { what, source } } else { self.ended(Some(&source)) }
    }

    fn ended(&mut self, error: Option<&Error>) -> ControllerError {
        let (status, message) = match &mut self.process {
            None => {
                let detail = error.map(|error| format!(": {error}")).unwrap_or_default();
                let words = self.stream.messages();
                (format!("{}{detail}", words.end), words.gone.into())
            }
            Some(process) => {
                let status = match process.child.try_wait() {
                    Ok(Some(status)) => status.to_string(),
                    _ => "its end of the link is closed".into(),
                };
                let message =
                    std::fs::read_to_string(process.folder.path().join("stderr")).unwrap_or_default();
                // After its reason the emulator may list every register.
                (status, message.trim().lines().next().unwrap_or_default().into())
            }
        };
        ControllerError::Ended { status, last_sequence: self.last_sequence, message }
    }
}

const OVERLOADED: &str = "The firmware may hang, or the machine may be overloaded.";
