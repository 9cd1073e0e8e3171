//! A controller on a serial port: a real board.
//!
//! 8 data bits, no parity, one stop bit, raw. What the line loses is asked for again; what it damages is counted.

use super::line::{Bounds, Line};
use super::stream::Stream;
use super::{ControllerError, RemoteController, system};
use rustix::fs::OFlags;
use rustix::termios::{OptionalActions, QueueSelector, tcflush, tcgetattr, tcsetattr};
use std::fs::{File, OpenOptions};
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;
use std::time::{Duration, SystemTime};

/// Line speed of the boards, baud.
pub const BAUD: u32 = 500_000;
/// Waits for a board at that speed.
pub const BOUNDS: Bounds = Bounds { answer: Duration::from_secs(5), again: Duration::from_millis(300) };

/// Attaches to controllers.
#[derive(Debug)]
pub struct AttachedController;

impl AttachedController {
    /// Opens a port and asks who is there.
    pub fn open(port: &Path) -> Result<RemoteController, ControllerError> {
        Self::open_within(port, BOUNDS)
    }

    /// As [`Self::open`], with other waits.
    pub fn open_within(port: &Path, bounds: Bounds) -> Result<RemoteController, ControllerError> {
        let file = raw(port).map_err(|source| ControllerError::Port { path: port.into(), source })?;
        let other = file.try_clone().map_err(system("the port's other direction"))?;
        let line = Line::new(Stream::Files { to_controller: file, to_host: other }, None, bounds);
        RemoteController::identified("attached", line, token())
    }
}

/// Any number that the last host is not likely to have used.
pub(super) fn token() -> u32 {
    SystemTime::UNIX_EPOCH.elapsed().map_or(1, |since| since.as_micros() as u32)
}

/// Opens a port for bytes as they are, without waiting for a carrier.
fn raw(port: &Path) -> std::io::Result<File> {
    let flags = (OFlags::NOCTTY | OFlags::NONBLOCK).bits() as i32;
    let file = OpenOptions::new().read(true).write(true).custom_flags(flags).open(port)?;
    let mut settings = tcgetattr(&file)?;
    settings.make_raw();
    settings.set_speed(BAUD)?;
    tcsetattr(&file, OptionalActions::Now, &settings)?;
    tcflush(&file, QueueSelector::IOFlush)?;
    Ok(file)
}
