//! Positions of writer and reader in one RTT channel, the circular buffer that debug probes serve.
//!
//! One side is this firmware. The other side is a probe that accesses the memory at the same time
//! and may disappear at any moment. Neither side waits for the other. A frame is written completely
//! or not at all: the writer's position moves after all bytes are stored. One byte of the buffer
//! always stays free. A position outside the buffer, which only a faulty probe writes, is taken
//! modulo the length.

use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};

/// Positions in the layout that probes expect. The length of the buffer is a power of two.
#[repr(C)]
#[derive(Debug, Default)]
pub struct Positions {
    /// Index of the next byte to be written.
    write: AtomicU32,
    /// Index of the next byte to be read.
    read: AtomicU32,
}

impl Positions {
    /// Creates the positions of an empty buffer.
    #[must_use]
    pub const fn new() -> Self {
        Self { write: AtomicU32::new(0), read: AtomicU32::new(0) }
    }

    /// Writes all bytes. Writes nothing and returns false unless `reserve` bytes stay free
    /// afterwards.
    #[must_use]
    pub fn write<const LENGTH: usize>(
        &self,
        buffer: &[AtomicU8; LENGTH],
        bytes: &[u8],
        reserve: usize,
    ) -> bool {
        let write = wrap::<LENGTH>(self.write.load(Ordering::Relaxed));
        let read = wrap::<LENGTH>(self.read.load(Ordering::Acquire));
        let free = wrap::<LENGTH>(read.wrapping_sub(write).wrapping_sub(1)) as usize;
        if bytes.len().saturating_add(reserve) > free {
            return false;
        }
        self.write.store(fill(buffer, write, bytes), Ordering::Release);
        true
    }

    /// Writes all bytes, over unread ones if necessary.
    pub fn overwrite<const LENGTH: usize>(&self, buffer: &[AtomicU8; LENGTH], bytes: &[u8]) {
        let write = self.write.load(Ordering::Relaxed);
        self.write.store(fill(buffer, write, bytes), Ordering::Release);
    }

    /// Takes the oldest byte.
    pub fn take<const LENGTH: usize>(&self, buffer: &[AtomicU8; LENGTH]) -> Option<u8> {
        let read = wrap::<LENGTH>(self.read.load(Ordering::Relaxed));
        if read == wrap::<LENGTH>(self.write.load(Ordering::Acquire)) {
            return None;
        }
        let byte = buffer.get(read as usize)?.load(Ordering::Relaxed);
        self.read.store(wrap::<LENGTH>(read.wrapping_add(1)), Ordering::Release);
        Some(byte)
    }

    /// Returns the writer's and the reader's position as a probe accesses them.
    #[must_use]
    pub fn as_words(&self) -> [&AtomicU32; 2] {
        [&self.write, &self.read]
    }
}

/// Stores bytes from an index on, wrapping at the end of the buffer. Returns the index after them.
fn fill<const LENGTH: usize>(buffer: &[AtomicU8; LENGTH], from: u32, bytes: &[u8]) -> u32 {
    let mut index = wrap::<LENGTH>(from);
    for &byte in bytes {
        if let Some(slot) = buffer.get(index as usize) {
            slot.store(byte, Ordering::Relaxed);
        }
        index = wrap::<LENGTH>(index.wrapping_add(1));
    }
    index
}

/// Returns a position modulo the buffer's length.
const fn wrap<const LENGTH: usize>(position: u32) -> u32 {
    const {
        assert!(LENGTH.is_power_of_two() && LENGTH < 1 << 31, "the length of a buffer is a power of two");
    };
    position & (LENGTH as u32).wrapping_sub(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const LENGTH: usize = 16;

    fn buffer() -> [AtomicU8; LENGTH] {
        [const { AtomicU8::new(0) }; LENGTH]
    }

    proptest! {
        #[test]
        fn complete_frames_are_read_in_order_and_frames_without_room_leave_no_trace(
            rounds in prop::collection::vec((0..20_usize, 0..4_usize, 0..20_usize), 1..60),
        ) {
            let (positions, buffer) = (Positions::new(), buffer());
            let (mut next, mut unread) = (0_u8, std::collections::VecDeque::new());
            for (written, reserve, read) in rounds {
                let bytes: Vec<u8> = (0..written).map(|index| next.wrapping_add(index as u8)).collect();
                let fits = unread.len() + written + reserve < LENGTH;
                prop_assert_eq!(positions.write(&buffer, &bytes, reserve), fits);
                if fits {
                    unread.extend(&bytes);
                    next = next.wrapping_add(written as u8);
                }
                for _ in 0..read {
                    prop_assert_eq!(positions.take(&buffer), unread.pop_front());
                }
            }
        }

        #[test]
        fn arbitrary_positions_from_a_faulty_probe_are_tolerated(
            write in any::<u32>(), read in any::<u32>(), bytes in prop::collection::vec(any::<u8>(), 0..20)
        ) {
            let (positions, buffer) = (Positions { write: write.into(), read: read.into() }, buffer());
            let unread = (write.wrapping_sub(read) % LENGTH as u32) as usize;
            let fits = unread + bytes.len() < LENGTH;
            prop_assert_eq!(positions.write(&buffer, &bytes, 0), fits);
            let taken = std::iter::from_fn(|| positions.take(&buffer)).count();
            prop_assert_eq!(taken, unread + if fits { bytes.len() } else { 0 });
        }
    }

    #[test]
    fn an_unread_log_overwrites_its_oldest_bytes() {
        let (positions, buffer) = (Positions::new(), buffer());
        for byte in 0..40 {
            positions.overwrite(&buffer, &[byte]);
        }
        assert_eq!(positions.as_words().map(|word| word.load(Ordering::Relaxed)), [40 % 16, 0]);
        assert_eq!(buffer.each_ref().map(|byte| byte.load(Ordering::Relaxed)).iter().max(), Some(&39));
    }
}
