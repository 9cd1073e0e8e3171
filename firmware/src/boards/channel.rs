//! One direction of RTT, the transport through memory that debug probes serve: where the writer and the reader of a circular buffer stand.
//!
//! One side is this firmware, the other a probe that reads and writes the memory meanwhile; either may go at any moment. Nobody waits.
//! What is put in is whole or not there at all: the writer's place moves once all bytes are in. One byte of a buffer always stays free. A
//! place outside the buffer, which only a faulty probe would write, is taken modulo the length.
//!
//! No addresses here, so that it is tested on the host.

use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};

/// The places, as probes expect them in memory. The buffer's length is a power of two.
#[repr(C)]
#[derive(Debug, Default)]
pub struct Places {
    /// Of the next byte to be written.
    write: AtomicU32,
    /// Of the next byte to be read.
    read: AtomicU32,
}

impl Places {
    /// Those of an empty buffer.
    #[must_use]
    pub const fn new() -> Self {
        Self { write: AtomicU32::new(0), read: AtomicU32::new(0) }
    }

    /// Puts in all of the bytes; false, and none of them, if that would not leave room for `spare` more.
    #[must_use]
    pub fn put<const LENGTH: usize>(&self, buffer: &[AtomicU8; LENGTH], bytes: &[u8], spare: usize) -> bool {
        let write = masked::<LENGTH>(self.write.load(Ordering::Relaxed));
        let read = masked::<LENGTH>(self.read.load(Ordering::Acquire));
        let room = masked::<LENGTH>(read.wrapping_sub(write).wrapping_sub(1)) as usize;
        if bytes.len().saturating_add(spare) > room {
            return false;
        }
        self.write.store(fill(buffer, write, bytes), Ordering::Release);
        true
    }

    /// Puts in all of the bytes, over unread ones if it must.
    pub fn put_over<const LENGTH: usize>(&self, buffer: &[AtomicU8; LENGTH], bytes: &[u8]) {
        let write = self.write.load(Ordering::Relaxed);
        self.write.store(fill(buffer, write, bytes), Ordering::Release);
    }

    /// Takes the oldest byte.
    pub fn take<const LENGTH: usize>(&self, buffer: &[AtomicU8; LENGTH]) -> Option<u8> {
        let read = masked::<LENGTH>(self.read.load(Ordering::Relaxed));
        if read == masked::<LENGTH>(self.write.load(Ordering::Acquire)) {
            return None;
        }
        let byte = buffer.get(read as usize)?.load(Ordering::Relaxed);
        self.read.store(masked::<LENGTH>(read.wrapping_add(1)), Ordering::Release);
        Some(byte)
    }

    /// The two places, the writer's first: what a probe sees.
    #[must_use]
    pub fn seen(&self) -> [&AtomicU32; 2] {
        [&self.write, &self.read]
    }
}

/// Writes bytes from a place on, round the end, and says where they end.
fn fill<const LENGTH: usize>(buffer: &[AtomicU8; LENGTH], from: u32, bytes: &[u8]) -> u32 {
    let mut at = masked::<LENGTH>(from);
    for &byte in bytes {
        if let Some(slot) = buffer.get(at as usize) {
            slot.store(byte, Ordering::Relaxed);
        }
        at = masked::<LENGTH>(at.wrapping_add(1));
    }
    at
}

/// A place within the buffer.
const fn masked<const LENGTH: usize>(place: u32) -> u32 {
    const { assert!(LENGTH.is_power_of_two() && LENGTH < 1 << 31, "the length of a buffer is a power of two") };
    place & (LENGTH as u32).wrapping_sub(1)
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
        fn what_is_put_in_whole_comes_out_in_order_and_the_rest_leaves_no_trace(
            rounds in prop::collection::vec((0..20_usize, 0..4_usize, 0..20_usize), 1..60),
        ) {
            let (places, buffer) = (Places::new(), buffer());
            let (mut next, mut within) = (0_u8, std::collections::VecDeque::new());
            for (written, spare, read) in rounds {
                let bytes: Vec<u8> = (0..written).map(|index| next.wrapping_add(index as u8)).collect();
                let fits = within.len() + written + spare < LENGTH;
                prop_assert_eq!(places.put(&buffer, &bytes, spare), fits);
                if fits {
                    within.extend(&bytes);
                    next = next.wrapping_add(written as u8);
                }
                for _ in 0..read {
                    prop_assert_eq!(places.take(&buffer), within.pop_front());
                }
            }
        }

        #[test]
        fn places_from_anywhere_are_borne(write in any::<u32>(), read in any::<u32>(), bytes in prop::collection::vec(any::<u8>(), 0..20)) {
            let (places, buffer) = (Places { write: write.into(), read: read.into() }, buffer());
            let waiting = (write.wrapping_sub(read) % LENGTH as u32) as usize;
            let fits = waiting + bytes.len() < LENGTH;
            prop_assert_eq!(places.put(&buffer, &bytes, 0), fits);
            let taken = std::iter::from_fn(|| places.take(&buffer)).count();
            prop_assert_eq!(taken, waiting + if fits { bytes.len() } else { 0 });
        }
    }

    #[test]
    fn a_log_nobody_reads_goes_on_over_its_oldest_bytes() {
        let (places, buffer) = (Places::new(), buffer());
        for byte in 0..40 {
            places.put_over(&buffer, &[byte]);
        }
        assert_eq!(places.seen().map(|place| place.load(Ordering::Relaxed)), [40 % 16, 0]);
        assert_eq!(buffer.each_ref().map(|byte| byte.load(Ordering::Relaxed)).iter().max(), Some(&39));
    }
}
