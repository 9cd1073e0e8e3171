//! A controller on a serial port: a real board.
//!
//! 8 data bits, no parity, one stop bit, raw. The host repeats what the line loses and counts what
//! it damages.

use super::line::{Line, Timeouts};
use super::stream::Stream;
use super::{ControllerError, RemoteController};
use controller::boards::LINK_BAUD;
use rustix::fs::OFlags;
use rustix::termios::{QueueSelector, tcflush};
use serial2::SerialPort;
use std::fs::File;
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;
use std::time::{Duration, SystemTime};

/// Timeouts for a board at that speed.
pub const TIMEOUTS: Timeouts = Timeouts { answer: Duration::from_secs(5), retry: Duration::from_millis(300) };

/// Opens boards on serial ports.
#[derive(Debug)]
pub struct AttachedController;

impl AttachedController {
    /// Opens a port and identifies the controller on it.
    pub fn open(port: &Path) -> Result<RemoteController, ControllerError> {
        Self::open_with(port, TIMEOUTS)
    }

    /// Opens a port with other timeouts.
    pub fn open_with(port: &Path, timeouts: Timeouts) -> Result<RemoteController, ControllerError> {
        let opened = open_port(port).map_err(|source| ControllerError::Port { path: port.into(), source })?;
        let line = Line::new(Stream::Port(opened), None, timeouts);
        RemoteController::handshake("attached", line, token())
    }
}

/// A number that the last host is unlikely to have used.
pub(super) fn token() -> u32 {
    SystemTime::UNIX_EPOCH.elapsed().map_or(1, |since| since.as_micros() as u32)
}

/// Opens a port for raw bytes and discards what has arrived so far.
fn open_port(path: &Path) -> std::io::Result<SerialPort> {
    // `SerialPort::open` waits without a timeout until the port has sent what another program has
    // left. Nothing of that is of use. Open until then: closing may switch the port's lines.
    let flags = (OFlags::NONBLOCK | OFlags::NOCTTY).bits() as i32;
    let discarding = File::options().read(true).write(true).custom_flags(flags).open(path)?;
    tcflush(&discarding, QueueSelector::IOFlush)?;
    let mut port = SerialPort::open(path, LINK_BAUD)?;
    // The line has its own timeouts: a transfer that cannot start must return at once.
    port.set_read_timeout(Duration::ZERO)?;
    port.set_write_timeout(Duration::ZERO)?;
    port.discard_buffers()?;
    Ok(port)
}
