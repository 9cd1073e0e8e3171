//! The emulated controller: the firmware's own image in QEMU, linked through two named pipes by semihosting.
//!
//! One write and one read a frame. While the controller waits for a frame its time stands still (`-icount`), so its
//! instruction counts repeat exactly.

use super::{Controller, ControllerError, Conversation, Heard, Losses, greeted, stopped, unexpected};
use link::track::SensorStatus;
use link::{
    Answer, Command as Order, ControllerConfiguration, Counters, Decoder, EstimateFrame, Hello, MAX_FRAME,
    SensorFrame, SlowFrame, ToController, ToHost, encode,
};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{CWD, FileType, Mode, mknodat};
use std::collections::VecDeque;
use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Read, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Bound on the emulator's start, up to its greeting.
const START_BOUND_S: u64 = 20;
/// Bound on every other answer.
const ANSWER_BOUND_S: u64 = 5;
/// How often a silent controller is checked for being alive.
const CHECK: Duration = Duration::from_millis(100);

const BOARD: &[&str] =
    &["-M", "netduinoplus2", "-display", "none", "-serial", "null", "-monitor", "none", "-no-reboot"];
const COUNTING: &[&str] = &["-semihosting-config", "enable=on,target=native", "-icount", "shift=6,sleep=off"];

/// A running emulator with a configured controller.
#[derive(Debug)]
pub struct EmulatedController {
    line: Line,
    hello: Hello,
    slow: Option<SlowFrame>,
}

/// The two pipes and what has come through them.
#[derive(Debug)]
struct Line {
    process: Process,
    to_controller: File,
    to_host: File,
    decoder: Decoder,
    conversation: Conversation,
    waiting: VecDeque<ToHost>,
    last_sequence: Option<u32>,
}

/// The emulator and its folder; both go when this is dropped.
#[derive(Debug)]
struct Process {
    child: Child,
    folder: tempfile::TempDir,
}

impl Drop for Process {
    fn drop(&mut self) {
        // Either it has ended already, or it must.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn system(what: &'static str) -> impl Fn(std::io::Error) -> ControllerError {
    move |source| ControllerError::System { what, source }
}

impl EmulatedController {
    /// Where `cargo xtask firmware` puts the image: the target folder of cargo, below the current directory or this
    /// source tree.
    pub fn default_elf() -> PathBuf {
        let tail = Path::new("thumbv7em-none-eabihf/firmware/estimator");
        let target = std::env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into());
        let here = Path::new(&target).join(tail);
        let source_tree = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        if here.exists() { here } else { source_tree.join(target).join(tail) }
    }

    /// Starts the emulator with an image, waits for its greeting and configures it.
    pub fn start(configuration: ControllerConfiguration, elf: &Path) -> Result<Self, ControllerError> {
        let elf = elf.canonicalize().map_err(|_| ControllerError::FirmwareMissing { path: elf.into() })?;
        is_for_arm(&elf)?;
        let folder =
            tempfile::Builder::new().prefix("pintle-").tempdir().map_err(system("a folder for the link"))?;
        let [to_controller, to_host] = ["to-controller", "to-host"].map(|name| folder.path().join(name));
        for pipe in [&to_controller, &to_host] {
            mknodat(CWD, pipe, FileType::Fifo, Mode::RUSR | Mode::WUSR, 0)
                .map_err(|e| system("a pipe for the link")(e.into()))?;
        }
        // Non-blocking: opening must not wait for an emulator that never comes. Opened for both directions, the first
        // pipe exists for its reader until it is closed here.
        let nonblocking = rustix::fs::OFlags::NONBLOCK.bits() as i32;
        let mut options = OpenOptions::new();
        options.read(true).custom_flags(nonblocking);
        let to_host = options.open(&to_host).map_err(system("the pipe from the controller"))?;
        let to_controller =
            options.write(true).open(&to_controller).map_err(system("the pipe to the controller"))?;
        let said =
            File::create(folder.path().join("said")).map_err(system("a file for the emulator's messages"))?;
        let child = Command::new("qemu-system-arm")
            .args(BOARD)
            .args(COUNTING)
            .arg("-kernel")
            .arg(&elf)
            .current_dir(folder.path())
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(said)
            .spawn()
            .map_err(|source| match source.kind() {
                ErrorKind::NotFound => ControllerError::EmulatorMissing,
                _ => ControllerError::System { what: "qemu-system-arm", source },
            })?;
        let mut line = Line {
            process: Process { child, folder },
            to_controller,
            to_host,
            decoder: Decoder::new(),
            conversation: Conversation::default(),
            waiting: VecDeque::new(),
            last_sequence: None,
        };
        let cause = "The image may not be this project's firmware, or may have crashed at its start.";
        let greeting = line.answer("its greeting", START_BOUND_S, cause).map_err(|error| match error {
            ControllerError::Ended { status, said, .. } => ControllerError::NotFirmware {
                path: elf.clone(),
                found: format!("an image that ended before its greeting ({status}: {said})"),
            },
            other => other,
        })?;
        let hello = match line.conversation.hear(greeting) {
            Heard::Started(hello) => greeted(hello)?,
            other => return Err(unexpected(&other, "a greeting")),
        };
        let mut controller = Self { line, hello, slow: None };
        controller.order(Order::Configure(configuration))?;
        Ok(controller)
    }

    /// Sends raw bytes, as a disturbed line would, and returns the controller's answer.
    pub fn disturb(&mut self, bytes: &[u8]) -> Result<ToHost, ControllerError> {
        self.line.send(bytes)?;
        self.line.answer("disturbed bytes", ANSWER_BOUND_S, "The bytes may hold no end of a frame.")
    }

    /// The next message but for slow telemetry, which is kept.
    fn hear(&mut self, waiting_for: &'static str) -> Result<Heard, ControllerError> {
        let cause = "The firmware may hang, or the machine be overloaded.";
        loop {
            let message = self.line.answer(waiting_for, ANSWER_BOUND_S, cause)?;
            match self.line.conversation.hear(message) {
                Heard::Slow(slow) => self.slow = Some(slow),
                heard => return Ok(heard),
            }
        }
    }

    /// The emulator's process identifier, for tests that end it.
    pub fn process_id(&self) -> u32 {
        self.line.process.child.id()
    }
}

impl Controller for EmulatedController {
    fn name(&self) -> &'static str {
        "emulated"
    }

    fn hello(&self) -> &Hello {
        &self.hello
    }

    fn exchange(&mut self, frame: &SensorFrame) -> Result<EstimateFrame, ControllerError> {
        self.line.send_message(&ToController::Sensor(*frame, SensorStatus::GOOD))?;
        match self.hear("a sample")? {
            Heard::Estimate(estimate) if estimate.sequence == frame.sequence => {
                self.line.last_sequence = Some(frame.sequence);
                Ok(estimate)
            }
            Heard::Started(_) => Err(ControllerError::Restarted { last_sequence: self.line.last_sequence }),
            other => Err(unexpected(&other, &format!("the estimate of sample {}", frame.sequence))),
        }
    }

    fn finish(mut self: Box<Self>) -> Result<Counters, ControllerError> {
        stopped(self.order(Order::Stop)?)
    }

    fn order(&mut self, command: Order) -> Result<Answer, ControllerError> {
        let message = self.line.conversation.order(command);
        self.line.send_message(&message)?;
        match self.hear("a command")? {
            Heard::Outcome(outcome) => outcome.map_err(ControllerError::Refused),
            other => Err(unexpected(&other, "the answer to a command")),
        }
    }

    fn heard(&self) -> (Option<SlowFrame>, Losses) {
        (self.slow, *self.line.conversation.losses())
    }
}

/// An ELF file for a 32-bit ARM core. The emulator would run anything else as raw machine code.
fn is_for_arm(path: &Path) -> Result<(), ControllerError> {
    /// `e_machine`, little endian.
    const ARM: [u8; 2] = [40, 0];
    let mut start = [0; 20];
    let read = File::open(path).and_then(|mut file| file.read_exact(&mut start));
    let found = match read {
        Err(error) if error.kind() != ErrorKind::UnexpectedEof => error.to_string(),
        Ok(()) if start.starts_with(b"\x7fELF\x01\x01") && start.ends_with(&ARM) => return Ok(()),
        _ => "no ELF image for ARM".into(),
    };
    Err(ControllerError::NotFirmware { path: path.into(), found })
}

impl Line {
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

    fn answer(
        &mut self,
        waiting_for: &'static str,
        bound_s: u64,
        cause: &'static str,
    ) -> Result<ToHost, ControllerError> {
        let deadline = Instant::now() + Duration::from_secs(bound_s);
        let mut buffer = [0; 4 * MAX_FRAME];
        loop {
            if let Some(message) = self.waiting.pop_front() {
                return Ok(message);
            }
            match self.to_host.read(&mut buffer) {
                Ok(0) => self.check_alive()?,
                Ok(count) => {
                    for &byte in buffer.iter().take(count) {
                        match self.decoder.push::<ToHost>(byte) {
                            None => {}
                            Some(Ok(message)) => self.waiting.push_back(message),
                            Some(Err(error)) => return Err(ControllerError::Frame(error)),
                        }
                    }
                    continue;
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => {
                    if self.wait()? {
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

    /// Waits a moment for bytes; false if none came.
    fn wait(&self) -> Result<bool, ControllerError> {
        let moment = Timespec { tv_sec: 0, tv_nsec: CHECK.as_nanos() as i64 };
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
        match self.process.child.try_wait() {
            Ok(None) => {
                std::thread::sleep(Duration::from_millis(1));
                Ok(())
            }
            _ => Err(self.ended()),
        }
    }

    fn ended(&mut self) -> ControllerError {
        let status = match self.process.child.try_wait() {
            Ok(Some(status)) => status.to_string(),
            _ => "its end of the link is closed".into(),
        };
        let said = std::fs::read_to_string(self.process.folder.path().join("said")).unwrap_or_default();
        // After its reason the emulator may list every register.
        let said = said.trim().lines().next().unwrap_or_default().into();
        ControllerError::Ended { status, last_sequence: self.last_sequence, said }
    }
}
