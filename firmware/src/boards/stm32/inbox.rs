//! Bytes that a DMA stream receives in a circular buffer.

use core::sync::atomic::{AtomicU8, Ordering};

use controller::buffers::dma_ring::DmaRing;

/// Length of the buffer, bytes.
pub(in crate::boards) const LENGTH: usize = 1024;

/// Registers of a DMA stream that writes the buffer repeatedly.
pub trait Stream {
    /// Starts at index 0 of the buffer.
    fn start(&self);
    /// Decides whether the stream runs. It stops by itself only after a bus error.
    fn is_running(&self) -> bool;
    /// Returns the index that is written next, below [`LENGTH`].
    fn position(&self) -> usize;
    /// Returns whether the stream has reached the end of the buffer since the last call.
    fn take_wrap(&self) -> bool;
}

/// Receiving half for the link service.
pub struct Inbox<S> {
    /// `None` without DMA.
    stream: Option<S>,
    buffer: &'static [AtomicU8; LENGTH],
    ring: DmaRing<LENGTH>,
}

impl<S: Stream> Inbox<S> {
    /// Takes a running stream that writes this buffer, or none.
    pub(in crate::boards) const fn new(stream: Option<S>, buffer: &'static [AtomicU8; LENGTH]) -> Self {
        Self { stream, buffer, ring: DmaRing::new() }
    }

    /// Takes the next byte that DMA has stored.
    pub(in crate::boards) fn take(&mut self) -> Option<u8> {
        let stream = self.stream.as_ref()?;
        if !stream.is_running() {
            stream.start();
        }
        // If the position has not decreased between two readings, no wrap lies between them, so
        // that the flag belongs to both.
        let mut has_wrapped = false;
        let mut before = stream.position();
        for _ in 0..2 {
            has_wrapped |= stream.take_wrap();
            let now = stream.position();
            if now >= before {
                self.ring.update(now, has_wrapped);
                break;
            }
            before = now;
        }
        let position = self.ring.take()?;
        self.buffer.get(position).map(|byte| byte.load(Ordering::Relaxed))
    }

    /// Returns the number of bytes that were overwritten before they were taken.
    pub(in crate::boards) fn lost(&self) -> u32 {
        self.ring.lost()
    }
}
