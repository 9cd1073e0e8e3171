//! What a debug probe finds in memory: the channels of RTT. One carries the log; a pair carries the link, as the serial port does.
//!
//! | channel | direction | bytes | full |
//! |---|---|---|---|
//! | `defmt` | to the host | 1,024 | goes on over its oldest bytes |
//! | `link` | to the host | 1,024 | a frame without room is not sent, and counted by whoever sends it |
//! | `link` | to the controller | 512 | the host waits |
//!
//! All three hang from a control block that the probe finds by its name in the image, as it does the build's name. Nothing ever waits, and
//! without a probe nothing happens.

use core::sync::atomic::{AtomicPtr, AtomicU8, AtomicU32};

use link::{BUILD_ID_LEN, MAX_FRAME};

use super::BUILD_ID;
use super::channel::Places;

const LOG: usize = 1024;
const UP: usize = 1024;
const DOWN: usize = 512;

static LOG_BUFFER: [AtomicU8; LOG] = [const { AtomicU8::new(0) }; LOG];
static UP_BUFFER: [AtomicU8; UP] = [const { AtomicU8::new(0) }; UP];
static DOWN_BUFFER: [AtomicU8; DOWN] = [const { AtomicU8::new(0) }; DOWN];
static LOG_NAME: [u8; 6] = *b"defmt\0";
static LINK_NAME: [u8; 5] = *b"link\0";

/// The build's name where a probe finds it: whether the host has the image that runs here.
#[expect(unsafe_code, reason = "probes find it by this name")]
#[unsafe(no_mangle)]
#[used]
static PINTLE_BUILD_ID: [u8; BUILD_ID_LEN] = padded(BUILD_ID);

/// A channel.
#[repr(C)]
struct Channel {
    name: AtomicPtr<u8>,
    buffer: AtomicPtr<AtomicU8>,
    size: u32,
    places: Places,
    /// What a writer does without room; for the probe only.
    flags: AtomicU32,
}

/// The control block: identifier, how many channels to the host, how many from it, the channels.
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
        places: Places::new(),
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

/// Puts bytes of the log in.
pub(super) fn log(bytes: &[u8]) {
    _SEGGER_RTT.log.places.put_over(&LOG_BUFFER, bytes);
}

/// The link's pair, for the link's loop.
pub struct Probe(());

impl Probe {
    pub(super) const fn new() -> Self {
        Self(())
    }

    /// The next byte that has come.
    pub fn take(&mut self) -> Option<u8> {
        _SEGGER_RTT.down.places.take(&DOWN_BUFFER)
    }

    /// Sends a frame, whole or not at all; false if there was no room.
    #[must_use]
    pub fn write(&mut self, bytes: &[u8]) -> bool {
        _SEGGER_RTT.up.places.put(&UP_BUFFER, bytes, 0)
    }

    /// The same with what nobody has asked for: it leaves room for an answer, so that a host which does not read for a while gets its next one.
    #[must_use]
    pub fn tell(&mut self, bytes: &[u8]) -> bool {
        _SEGGER_RTT.up.places.put(&UP_BUFFER, bytes, MAX_FRAME)
    }
}

/// The first bytes of a name, and zeros.
const fn padded(name: &str) -> [u8; BUILD_ID_LEN] {
    let mut bytes = [0; BUILD_ID_LEN];
    let (mut to, mut from) = (bytes.as_mut_slice(), name.as_bytes());
    while let ([first, to_rest @ ..], [byte, from_rest @ ..]) = (to, from) {
        *first = *byte;
        (to, from) = (to_rest, from_rest);
    }
    bytes
}
