//! The emulated controller with its link on two pipes and, if requested, a debugger stub.
//!
//! Bytes are written as fast as the controller reads them, and every received message is stored in
//! order. A reset restarts the firmware on the same pipes. While the controller waits for bytes,
//! the emulator does not answer the debugger. To stop it, set a breakpoint first and have bytes
//! left to send ([`Emulator::pump`]). Every wait has a timeout.

use super::CampaignError;
use super::gdb::Gdb;
use super::wait::{system, wait};
use controller::emulator::MACHINE;
use link::{Decoder, FrameError, ToHost};
use rustix::event::{PollFd, PollFlags};
use rustix::fs::{CWD, FileType, Mode, mknodat};
use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Read, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

const ARGUMENTS: [&str; 8] = ["-M", MACHINE, "-display", "none", "-serial", "null", "-monitor", "none"];
const COUNTING: [&str; 4] =
    ["-semihosting-config", "enable=on,target=native", "-icount", "shift=6,sleep=off"];
/// Limit of a pump, in timeouts: a faulty controller may send messages for ever.
const MAX_TIMEOUTS: u32 = 12;
/// A message, or the error of a damaged frame.
pub type Received = Result<ToHost, FrameError>;

/// Reason for which [`Emulator::pump`] returned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PumpEnd {
    /// The awaited message arrived.
    Arrived,
    /// The core stopped at a breakpoint.
    Stopped,
    /// The emulator process ended.
    Exited,
    /// No message arrived within the timeout, or never the awaited one.
    TimedOut,
}

/// A running emulator; dropping it ends the process.
#[derive(Debug)]
pub struct Emulator {
    child: Child,
    _folder: tempfile::TempDir,
    to_controller: File,
    to_host: File,
    gdb: Option<Gdb>,
    pending: Vec<u8>,
    decoder: Decoder,
    /// All messages received so far.
    pub received: Vec<Received>,
}

impl Drop for Emulator {
    fn drop(&mut self) {
        // The process may have ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Emulator {
    /// Starts an image. With a debugger, the core is stopped before its first instruction.
    pub fn start(elf: &Path, with_debugger: bool, more: &[&str]) -> Result<Self, CampaignError> {
        let folder =
            tempfile::Builder::new().prefix("pintle-").tempdir().map_err(system("a folder for the link"))?;
        let [to_controller, to_host] = ["to-controller", "to-host"].map(|name| folder.path().join(name));
        for pipe in [&to_controller, &to_host] {
            mknodat(CWD, pipe, FileType::Fifo, Mode::RUSR | Mode::WUSR, 0)
                .map_err(|error| system("a pipe for the link")(error.into()))?;
        }
        // Opened in both directions, so that neither side blocks on the other, even during a reset.
        let nonblocking = rustix::fs::OFlags::NONBLOCK.bits() as i32;
        let open =
            |path: &Path| OpenOptions::new().read(true).write(true).custom_flags(nonblocking).open(path);
        let to_controller = open(&to_controller).map_err(system("the pipe to the controller"))?;
        let to_host = open(&to_host).map_err(system("the pipe from the controller"))?;
        let mut command = Command::new("qemu-system-arm");
        command.args(ARGUMENTS).args(COUNTING).args(more).arg("-kernel").arg(elf).current_dir(folder.path());
        if with_debugger {
            command.args(["-S", "-gdb", "unix:debug,server=on,wait=off"]);
        }
        let child = command
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .map_err(system("qemu-system-arm"))?;
        let socket = folder.path().join("debug");
        let mut emulator = Self {
            child,
            _folder: folder,
            to_controller,
            to_host,
            gdb: None,
            pending: vec![],
            decoder: Decoder::new(),
            received: vec![],
        };
        if with_debugger {
            emulator.gdb = Some(Gdb::connect(&socket)?);
        }
        Ok(emulator)
    }

    /// Returns the debugger connection.
    pub(crate) fn gdb(&mut self) -> Result<&mut Gdb, CampaignError> {
        self.gdb
            .as_mut()
            .ok_or(CampaignError::Debugger { found: "none".into(), expected: "an emulator with one" })
    }

    /// Returns the emulator's process identifier.
    pub fn process_id(&self) -> u32 {
        self.child.id()
    }

    /// Queues bytes to send.
    pub fn send(&mut self, bytes: &[u8]) {
        self.pending.extend_from_slice(bytes);
    }

    /// Writes queued bytes and reads messages until the awaited one has arrived, the core stops,
    /// the emulator ends, or no byte moves within the timeout. [`MAX_TIMEOUTS`] timeouts are the
    /// limit.
    pub fn pump(
        &mut self,
        bound: Duration,
        mut has_arrived: impl FnMut(&[Received]) -> bool,
    ) -> Result<PumpEnd, CampaignError> {
        let begun = Instant::now();
        let mut last = begun;
        loop {
            let moved = self.write()? | self.read()?;
            if let Some(gdb) = &mut self.gdb
                && gdb.has_stopped()?
            {
                // Read what was sent before the core stopped.
                self.read()?;
                return Ok(PumpEnd::Stopped);
            }
            if has_arrived(&self.received) {
                return Ok(PumpEnd::Arrived);
            }
            if moved && begun.elapsed() <= MAX_TIMEOUTS * bound {
                last = Instant::now();
                continue;
            }
            if !matches!(self.child.try_wait(), Ok(None)) {
                // Read the last messages.
                self.read()?;
                return Ok(if has_arrived(&self.received) { PumpEnd::Arrived } else { PumpEnd::Exited });
            }
            if last.elapsed() > bound || begun.elapsed() > MAX_TIMEOUTS * bound {
                return Ok(PumpEnd::TimedOut);
            }
            self.wait()?;
        }
    }

    fn write(&mut self) -> Result<bool, CampaignError> {
        let mut moved = false;
        while !self.pending.is_empty() {
            match self.to_controller.write(&self.pending) {
                Ok(count) => {
                    self.pending.drain(..count);
                    moved = true;
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(system("the pipe to the controller")(error)),
            }
        }
        Ok(moved)
    }

    fn read(&mut self) -> Result<bool, CampaignError> {
        let mut buffer = [0; 16_384];
        let mut moved = false;
        loop {
            match self.to_host.read(&mut buffer) {
                Ok(0) => return Ok(moved),
                Ok(count) => {
                    moved = true;
                    let bytes = buffer.iter().take(count);
                    self.received.extend(bytes.filter_map(|&byte| self.decoder.push::<ToHost>(byte)));
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => return Ok(moved),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(system("the pipe from the controller")(error)),
            }
        }
    }

    fn wait(&self) -> Result<(), CampaignError> {
        let mut watched = vec![PollFd::new(&self.to_host, PollFlags::IN)];
        if !self.pending.is_empty() {
            watched.push(PollFd::new(&self.to_controller, PollFlags::OUT));
        }
        if let Some(gdb) = &self.gdb {
            watched.push(PollFd::new(gdb.stream(), PollFlags::IN));
        }
        wait(&mut watched, Duration::from_millis(50))
    }
}
