//! The link over the board's serial port.

use core::sync::atomic::{AtomicU32, Ordering};

use controller::service::{LineReport, Purpose, Received, Transport};
use heapless::spsc::{Consumer, Producer};
use link::LineErrors;

use super::microcontroller::{Inbox, Receiver, Transmitter};

/// Received bytes that found no room.
static DROPPED_BYTES: AtomicU32 = AtomicU32::new(0);
/// Errors that the port detected.
static OVERRUNS: AtomicU32 = AtomicU32::new(0);
static FRAMING: AtomicU32 = AtomicU32::new(0);
static NOISE: AtomicU32 = AtomicU32::new(0);

/// Counts receive errors and stores the byte if bytes arrive by interrupt. A byte without room is
/// dropped and counted; its frame fails its checksum. To be called from the port's interrupt.
pub fn receive(receiver: &mut Receiver, bytes: &mut Producer<'static, u8>) {
    let received = receiver.fetch();
    if let Some(byte) = received.byte
        && bytes.enqueue(byte).is_err()
    {
        DROPPED_BYTES.fetch_add(1, Ordering::Relaxed);
    }
    OVERRUNS.fetch_add(received.errors.overruns, Ordering::Relaxed);
    FRAMING.fetch_add(received.errors.framing, Ordering::Relaxed);
    NOISE.fetch_add(received.errors.noise, Ordering::Relaxed);
}

/// Serial port with the bytes that DMA or the interrupt has stored.
pub struct SerialTransport {
    inbox: Inbox,
    bytes: Consumer<'static, u8>,
    transmitter: Transmitter,
}

impl SerialTransport {
    /// Takes both ways in and the way out.
    #[must_use]
    pub const fn new(inbox: Inbox, bytes: Consumer<'static, u8>, transmitter: Transmitter) -> Self {
        Self { inbox, bytes, transmitter }
    }
}

impl Transport for SerialTransport {
    fn receive(&mut self) -> Received {
        self.inbox.take().or_else(|| self.bytes.dequeue()).map_or(Received::Nothing, Received::Byte)
    }

    fn send(&mut self, frame: &[u8], _purpose: Purpose) -> bool {
        self.transmitter.write(frame)
    }

    fn line(&self) -> LineReport {
        LineReport {
            dropped_bytes: DROPPED_BYTES.load(Ordering::Relaxed).saturating_add(self.inbox.lost()),
            errors: LineErrors {
                overruns: OVERRUNS.load(Ordering::Relaxed),
                framing: FRAMING.load(Ordering::Relaxed),
                noise: NOISE.load(Ordering::Relaxed),
            },
        }
    }
}
