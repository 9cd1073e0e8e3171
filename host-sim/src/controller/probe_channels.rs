//! The two ring buffers of the link in a controller's memory, read and written by a debug probe.

use crate::flash::probe::{CORE, with_causes};
use probe_rs::rtt::{DownChannel, Error as RttError, Rtt, UpChannel};
use probe_rs::{Core, Session};
use std::io::{Error, ErrorKind, Result as Outcome};
use std::time::Duration;

/// Pause between two reads of a buffer: less than a read takes over USB.
pub(super) const PAUSE: Duration = Duration::from_micros(100);
/// Name of the link's channels.
const LINK: &str = "link";

/// The link's channels.
pub(super) fn channels(rtt: Rtt) -> Option<(UpChannel, DownChannel)> {
    let up = rtt.up_channels.into_iter().find(|channel| channel.name() == Some(LINK))?;
    let down = rtt.down_channels.into_iter().find(|channel| channel.name() == Some(LINK))?;
    Some((up, down))
}

/// The two buffers of the link.
#[derive(Debug)]
pub(super) struct Channels {
    pub(super) session: Session,
    pub(super) block: u64,
    /// None during a restart of the controller.
    pub(super) open: Option<(UpChannel, DownChannel)>,
}

impl Channels {
    /// Reads bytes from the controller.
    pub(super) fn read(&mut self, buffer: &mut [u8]) -> Outcome<usize> {
        self.with(|core, (up, _)| up.read(core, buffer))
    }

    /// Writes as many bytes as there is room for.
    pub(super) fn write(&mut self, bytes: &[u8]) -> Outcome<usize> {
        self.with(|core, (_, down)| down.write(core, bytes))
    }

    fn with(
        &mut self,
        transfer: impl FnOnce(&mut Core, &mut (UpChannel, DownChannel)) -> Result<usize, RttError>,
    ) -> Outcome<usize> {
        let mut core = self.session.core(CORE).map_err(|error| Error::other(with_causes(&error)))?;
        let moved = match &mut self.open {
            Some(open) => transfer(&mut core, open),
            // The next call may transfer bytes.
            None => Rtt::attach_at(&mut core, self.block).map(|rtt| {
                self.open = channels(rtt);
                0
            }),
        };
        match moved {
            Ok(0) => Err(ErrorKind::WouldBlock.into()),
            Ok(count) => Ok(count),
            Err(error @ (RttError::Probe(_) | RttError::MemoryRead(_))) => {
                Err(Error::other(with_causes(&error)))
            }
            // The controller is restarting: its buffers have moved or do not exist yet.
            Err(_) => {
                self.open = None;
                Err(ErrorKind::WouldBlock.into())
            }
        }
    }
}
