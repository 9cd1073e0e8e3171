//! RTT channels that a debug probe accesses in memory: one for the log, a pair for the link.
//!
//! | channel | direction | bytes | when full |
//! |---|---|---|---|
//! | `defmt` | to the host | 1,024 | the oldest bytes are overwritten |
//! | `link` | to the host | 1,024 | a frame without room is not sent, and its sender counts it |
//! | `link` | to the controller | 512 | the host waits |
//!
//! The probe finds the control block and the build name by their symbols in the image. The firmware
//! never waits for a probe.

use core::sync::atomic::{AtomicPtr, AtomicU8, AtomicU32};

use link::{BUILD_ID_LEN, MAX_FRAME};

use controller::buffers::rtt_channel::Positions;
use controller::service::{Purpose, Received, Transport};

const LOG: usize = 1024;
const UP: usize = 1024;
const DOWN: usize = 512;

static LOG_BUFFER: [AtomicU8; LOG] = [const { AtomicU8::new(0) }; LOG];
static UP_BUFFER: [AtomicU8; UP] = [const { AtomicU8::new(0) }; UP];
static DOWN_BUFFER: [AtomicU8; DOWN] = [const { AtomicU8::new(0) }; DOWN];
static LOG_NAME: [u8; 6] = *b"defmt\0";
static LINK_NAME: [u8; 5] = *b"link\0";

/// Build name for probes: the host compares it with that of its image.
#[expect(unsafe_code, reason = "probes find it by this name")]
#[unsafe(no_mangle)]
#[used]
pub(super) static PINTLE_BUILD_ID: [u8; BUILD_ID_LEN] = padded(match option_env!("PINTLE_BUILD_ID") {
    Some(id) => id,
    None => env!("CARGO_PKG_VERSION"),
});

/// A channel.
#[repr(C)]
struct Channel {
    name: AtomicPtr<u8>,
    buffer: AtomicPtr<AtomicU8>,
    size: u32,
    positions: Positions,
    /// Behaviour of a writer without room; for the probe only.
    flags: AtomicU32,
}

/// Control block: identifier, numbers of channels to and from the host, channels.
#[repr(C)]
struct ControlBlock {
    id: [u8; 16],
    channels_up: u32,
    channels_down: u32,
    log: Channel,
    up: Channel,
    down: Channel,
}

const fn channel<const LENGTH: usize>(name: &'static [u8], buffer: &'static [AtomicU8; LENGTH]) -> Channel {
    Channel {
        name: AtomicPtr::new(name.as_ptr().cast_mut()),
        buffer: AtomicPtr::new(buffer.as_ptr().cast_mut()),
        size: LENGTH as u32,
        positions: Positions::new(),
        flags: AtomicU32::new(0),
    }
}

#[expect(unsafe_code, reason = "probes find the control block by this name")]
#[unsafe(no_mangle)]
static _SEGGER_RTT: ControlBlock = ControlBlock {
    id: *b"SEGGER RTT\0\0\0\0\0\0",
    channels_up: 2,
    channels_down: 1,
    log: channel(&LOG_NAME, &LOG_BUFFER),
    up: channel(&LINK_NAME, &UP_BUFFER),
    down: channel(&LINK_NAME, &DOWN_BUFFER),
};

/// Writes bytes of the log.
pub(super) fn log(bytes: &[u8]) {
    _SEGGER_RTT.log.positions.overwrite(&LOG_BUFFER, bytes);
}

/// Pair of channels for the link.
pub struct Probe(());

impl Probe {
    pub(super) const fn new() -> Self {
        Self(())
    }
}

impl Transport for Probe {
    fn receive(&mut self) -> Received {
        _SEGGER_RTT.down.positions.take(&DOWN_BUFFER).map_or(Received::Nothing, Received::Byte)
    }

    /// Sends the complete frame or nothing. A stream frame leaves room for a reply, so that a host
    /// that does not read for a while still gets its next reply.
    fn send(&mut self, frame: &[u8], purpose: Purpose) -> bool {
        let reserve = match purpose {
            Purpose::Reply => 0,
            Purpose::Stream => MAX_FRAME,
        };
        _SEGGER_RTT.up.positions.write(&UP_BUFFER, frame, reserve)
    }
}

/// Returns the first bytes of a name, padded with zeros.
const fn padded(name: &str) -> [u8; BUILD_ID_LEN] {
    let mut bytes = [0; BUILD_ID_LEN];
    let (mut to, mut from) = (bytes.as_mut_slice(), name.as_bytes());
    while let ([first, to_rest @ ..], [byte, from_rest @ ..]) = (to, from) {
        *first = *byte;
        (to, from) = (to_rest, from_rest);
    }
    bytes
}
