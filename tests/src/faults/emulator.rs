//! The emulated controller with its link on two pipes and, where wanted, a debugger's stub.
//!
//! Bytes are written as fast as the controller takes them and everything it says is kept with its place in what was said; a reset starts the
//! firmware again on the same pipes. While the controller waits for bytes the emulator answers no debugger, so whoever wants to stop it
//! sets a breakpoint beforehand and has bytes left to send ([`Emulator::pump`]). Every wait is bounded.

use super::CampaignError;
use super::gdb::Gdb;
use link::{Decoder, FrameError, ToHost};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{CWD, FileType, Mode, mknodat};
use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Read, Write};
use std::os::fd::AsFd;
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

const MACHINE: [&str; 8] = ["-M", "netduinoplus2", "-display", "none", "-serial", "null", "-monitor", "none"];
const COUNTING: [&str; 4] =
    ["-semihosting-config", "enable=on,target=native", "-icount", "shift=6,sleep=off"];
/// A pump ends after so many times the bound on silence, whatever is said: a controller may say the same for ever.
const MOST_BOUNDS: u32 = 12;
/// Bytes that the host's decoder found damaged, or a message.
pub type Said = Result<ToHost, FrameError>;

/// Why [`Emulator::pump`] returned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pumped {
    /// What was waited for has come.
    Come,
    /// The core stands at a breakpoint.
    Stopped,
    /// The emulation has ended.
    Ended,
    /// Nothing came for the whole bound, or never what was waited for.
    Silent,
}

/// A running emulator. It ends with this.
#[derive(Debug)]
pub struct Emulator {
    child: Child,
    _folder: tempfile::TempDir,
    to_controller: File,
    to_host: File,
    gdb: Option<Gdb>,
    pending: Vec<u8>,
    decoder: Decoder,
    /// Everything that was said.
    pub said: Vec<Said>,
}

impl Drop for Emulator {
    fn drop(&mut self) {
        // Either it has ended already, or it must.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Emulator {
    /// Starts an image; with a debugger it stands before its first instruction.
    pub fn start(elf: &Path, with_debugger: bool, more: &[&str]) -> Result<Self, CampaignError> {
        let folder =
            tempfile::Builder::new().prefix("pintle-").tempdir().map_err(system("a folder for the link"))?;
        let [to_controller, to_host] = ["to-controller", "to-host"].map(|name| folder.path().join(name));
        for pipe in [&to_controller, &to_host] {
            mknodat(CWD, pipe, FileType::Fifo, Mode::RUSR | Mode::WUSR, 0)
                .map_err(|error| system("a pipe for the link")(error.into()))?;
        }
        // Opened for both directions, so that neither end waits for the other, a reset included.
        let nonblocking = rustix::fs::OFlags::NONBLOCK.bits() as i32;
        let open =
            |path: &Path| OpenOptions::new().read(true).write(true).custom_flags(nonblocking).open(path);
        let to_controller = open(&to_controller).map_err(system("the pipe to the controller"))?;
        let to_host = open(&to_host).map_err(system("the pipe from the controller"))?;
        let mut command = Command::new("qemu-system-arm");
        command.args(MACHINE).args(COUNTING).args(more).arg("-kernel").arg(elf).current_dir(folder.path());
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
            said: vec![],
        };
        if with_debugger {
            emulator.gdb = Some(Gdb::connect(&socket)?);
        }
        Ok(emulator)
    }

    /// The debugger.
    pub fn gdb(&mut self) -> Result<&mut Gdb, CampaignError> {
        self.gdb
            .as_mut()
            .ok_or(CampaignError::Debugger { found: "none".into(), expected: "an emulator with one" })
    }

    /// The emulator's process identifier.
    pub fn process_id(&self) -> u32 {
        self.child.id()
    }

    /// Queues bytes.
    pub fn send(&mut self, bytes: &[u8]) {
        self.pending.extend_from_slice(bytes);
    }

    /// Writes what is queued and takes what is said, until something has come, the core stands, nothing is left to wait for, nothing came for
    /// the bound, or it has taken [`MOST_BOUNDS`] of them.
    pub fn pump(
        &mut self,
        bound: Duration,
        mut come: impl FnMut(&[Said]) -> bool,
    ) -> Result<Pumped, CampaignError> {
        let begun = Instant::now();
        let mut last = begun;
        loop {
            let moved = self.write()? | self.read()?;
            if let Some(gdb) = &mut self.gdb
                && gdb.stopped()?
            {
                // What was said before the core stopped.
                self.read()?;
                return Ok(Pumped::Stopped);
            }
            if come(&self.said) {
                return Ok(Pumped::Come);
            }
            if moved && begun.elapsed() <= MOST_BOUNDS * bound {
                last = Instant::now();
                continue;
            }
            if !matches!(self.child.try_wait(), Ok(None)) {
                // What it said last.
                self.read()?;
                return Ok(if come(&self.said) { Pumped::Come } else { Pumped::Ended });
            }
            if last.elapsed() > bound || begun.elapsed() > MOST_BOUNDS * bound {
                return Ok(Pumped::Silent);
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
                    self.said.extend(bytes.filter_map(|&byte| self.decoder.push::<ToHost>(byte)));
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

/// Waits until something can be read, no longer than a bound.
pub(super) fn wait_for(stream: &impl AsFd, bound: Duration) -> Result<(), CampaignError> {
    wait(&mut [PollFd::new(stream, PollFlags::IN)], bound)
}

fn wait(watched: &mut [PollFd<'_>], bound: Duration) -> Result<(), CampaignError> {
    let bound = Timespec { tv_sec: 0, tv_nsec: bound.as_nanos() as i64 };
    match poll(watched, Some(&bound)) {
        Ok(_) | Err(rustix::io::Errno::INTR) => Ok(()),
        Err(error) => Err(system("waiting for the emulator")(error.into())),
    }
}

fn system(what: &'static str) -> impl Fn(std::io::Error) -> CampaignError {
    move |source| CampaignError::System { what, source }
}
