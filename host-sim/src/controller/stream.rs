//! The byte streams to a controller: two pipes, a serial port, or a debug probe.
//!
//! Reading and writing never wait: `WouldBlock` means that there are no bytes, or no room.
//! [`Stream::ready`] waits.

#[cfg(feature = "probe")]
use super::probe_channels::Channels;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use serial2::SerialPort;
use std::fs::File;
use std::io::{Error, ErrorKind, Read, Result, Write};
use std::os::fd::AsFd;
use std::time::Duration;

/// Both directions of a byte stream.
#[derive(Debug)]
pub(super) enum Stream {
    /// Serial port.
    Port(SerialPort),
    /// Pipes to the emulator.
    Pipes { to_controller: File, to_host: File },
    /// Buffers in the controller's memory, through a debug probe.
    #[cfg(feature = "probe")]
    Probe(Box<Channels>),
}

/// Parts of error messages about a stream.
pub(super) struct Messages {
    /// The stream has ended.
    pub(super) end: &'static str,
    /// Likely cause of the end.
    pub(super) gone: &'static str,
    /// Likely cause of a missing answer.
    pub(super) silent: &'static str,
    /// Likely cause of a full stream.
    pub(super) full: &'static str,
}

const PORT: Messages = Messages {
    end: "the port is closed",
    gone: "The adapter may have been unplugged, or the program that served the port may have ended.",
    silent: "Power, cable, port or line speed may be wrong, or the firmware may hang.",
    full: "The controller does not read: it may hang, or stop the line by flow control.",
};

#[cfg(feature = "probe")]
const PROBE: Messages = Messages {
    end: "the probe cannot access the controller's memory",
    gone: "The probe or the board may have been unplugged, or the board may have lost its power.",
    silent: "The core may be halted or held in reset, the firmware may hang, or it may be an image for the \
        emulator.",
    full: "The controller does not read: its core may be halted, or the firmware may hang.",
};

impl Stream {
    /// Writes some of the bytes and returns their number.
    pub(super) fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        match self {
            Self::Port(port) => port.write(bytes).map_err(would_block),
            Self::Pipes { to_controller, .. } => to_controller.write(bytes),
            #[cfg(feature = "probe")]
            Self::Probe(channels) => channels.write(bytes),
        }
    }

    /// Reads some bytes and returns their number; 0 at the end of the stream.
    pub(super) fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        match self {
            Self::Port(port) => port.read(buffer).map_err(would_block),
            Self::Pipes { to_host, .. } => to_host.read(buffer),
            #[cfg(feature = "probe")]
            Self::Probe(channels) => channels.read(buffer),
        }
    }

    /// Waits until the stream can be read (`IN`) or written (`OUT`). Returns false after
    /// `timeout`, or where only a trial shows it.
    pub(super) fn ready(&self, for_what: PollFlags, timeout: Duration) -> Result<bool> {
        let file = match self {
            Self::Port(port) => port.as_fd(),
            Self::Pipes { to_controller, .. } if for_what == PollFlags::OUT => to_controller.as_fd(),
            Self::Pipes { to_host, .. } => to_host.as_fd(),
            #[cfg(feature = "probe")]
            Self::Probe(_) => {
                std::thread::sleep(timeout.min(super::probe_channels::PAUSE));
                return Ok(false);
            }
        };
        let moment = Timespec { tv_sec: 0, tv_nsec: timeout.as_nanos() as i64 };
        match poll(&mut [PollFd::from_borrowed_fd(file, for_what)], Some(&moment)) {
            Ok(ready) => Ok(ready > 0),
            Err(rustix::io::Errno::INTR) => Ok(true),
            Err(error) => Err(error.into()),
        }
    }

    /// Messages for its failures. The emulator's pipes have their own, where the process is known.
    pub(super) const fn messages(&self) -> &'static Messages {
        match self {
            Self::Port(_) | Self::Pipes { .. } => &PORT,
            #[cfg(feature = "probe")]
            Self::Probe(_) => &PROBE,
        }
    }
}

/// The port reports a transfer that cannot start as a timeout without a system error. A timeout of
/// the system is a failure of the adapter.
fn would_block(error: Error) -> Error {
    let cannot_start = error.kind() == ErrorKind::TimedOut && error.raw_os_error().is_none();
    if cannot_start { ErrorKind::WouldBlock.into() } else { error }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_ports_own_timeout_means_that_there_are_no_bytes() {
        assert_eq!(would_block(ErrorKind::TimedOut.into()).kind(), ErrorKind::WouldBlock);
        let failed = Error::from(rustix::io::Errno::TIMEDOUT);
        assert_eq!(would_block(failed).kind(), ErrorKind::TimedOut);
        assert_eq!(would_block(ErrorKind::BrokenPipe.into()).kind(), ErrorKind::BrokenPipe);
    }
}
