//! What the bytes of a line go through: two files (pipes, or the directions of a serial port) or a debug probe.
//!
//! Reading and writing never wait: `WouldBlock` says that nothing is there, or no room. [`Stream::ready`] waits a moment.

#[cfg(feature = "probe")]
use super::probe::Channels;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use std::fs::File;
use std::io::{Read, Result, Write};
use std::time::Duration;

/// Both directions.
#[derive(Debug)]
pub(super) enum Stream {
    /// Pipes to the emulator, or a serial port.
    Files { to_controller: File, to_host: File },
    /// Buffers in the controller's memory, through a debug probe.
    #[cfg(feature = "probe")]
    Probe(Box<Channels>),
}

/// What an error says of a stream.
pub(super) struct Words {
    /// What its end is.
    pub(super) end: &'static str,
    /// The likely cause of that.
    pub(super) gone: &'static str,
    /// Why nothing may come through it.
    pub(super) silent: &'static str,
    /// Why it may be full.
    pub(super) full: &'static str,
}

const PORT: Words = Words {
    end: "the port is closed",
    gone: "The adapter may have been unplugged, or whoever served the port has gone.",
    silent: "Power, cable, port and line speed may be wrong, or the firmware hang.",
    full: "The controller does not read; it may hang, or hold the line by flow control.",
};

#[cfg(feature = "probe")]
const PROBE: Words = Words {
    end: "the probe gives no access to its memory",
    gone: "The probe or the board may have been unplugged, or the board lost its power.",
    silent: "The core may be halted or held in reset, the firmware hang, or its link go over the emulator's files.",
    full: "The controller does not read; its core may be halted, or the firmware hang.",
};

impl Stream {
    /// Takes some of the bytes and says how many.
    pub(super) fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        match self {
            Self::Files { to_controller, .. } => to_controller.write(bytes),
            #[cfg(feature = "probe")]
            Self::Probe(channels) => channels.write(bytes),
        }
    }

    /// Gives some bytes and says how many; 0 at the end of a file.
    pub(super) fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        match self {
            Self::Files { to_host, .. } => to_host.read(buffer),
            #[cfg(feature = "probe")]
            Self::Probe(channels) => channels.read(buffer),
        }
    }

    /// Waits a moment to be able to read (`IN`) or write (`OUT`); false if it is not, or cannot know before it has tried.
    pub(super) fn ready(&self, for_what: PollFlags, at_most: Duration) -> Result<bool> {
        let file = match self {
            Self::Files { to_controller, .. } if for_what == PollFlags::OUT => to_controller,
            Self::Files { to_host, .. } => to_host,
            #[cfg(feature = "probe")]
            Self::Probe(_) => {
                std::thread::sleep(at_most.min(super::probe::PAUSE));
                return Ok(false);
            }
        };
        let moment = Timespec { tv_sec: 0, tv_nsec: at_most.as_nanos() as i64 };
        match poll(&mut [PollFd::new(file, for_what)], Some(&moment)) {
            Ok(ready) => Ok(ready > 0),
            Err(rustix::io::Errno::INTR) => Ok(true),
            Err(error) => Err(error.into()),
        }
    }

    /// What to say when it fails; of the emulator's pipes others say it.
    pub(super) const fn words(&self) -> &'static Words {
        match self {
            Self::Files { .. } => &PORT,
            #[cfg(feature = "probe")]
            Self::Probe(_) => &PROBE,
        }
    }
}
