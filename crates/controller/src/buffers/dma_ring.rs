//! Reader of a circular buffer that a DMA controller writes.
//!
//! The writer never waits. [`DmaRing::update`] takes the writer's position and whether the writer
//! has wrapped since the last update, and derives how many bytes were written. If the writer has
//! overtaken the reader, all unread bytes are discarded and counted as lost; the link
//! resynchronises at the next delimiter.
//!
//! The count is exact if updates are at most one buffer length apart. After a longer pause it may
//! be too low, and overwritten bytes may be read: their frame fails its checksum.

/// Reader's side of a buffer of `LENGTH` bytes.
#[derive(Clone, Debug)]
pub struct DmaRing<const LENGTH: usize> {
    /// Writer's position at the last update.
    written: usize,
    /// Unread bytes before that position.
    unread: usize,
    lost: u32,
}

impl<const LENGTH: usize> Default for DmaRing<LENGTH> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const LENGTH: usize> DmaRing<LENGTH> {
    /// Creates the reader of an empty buffer whose writer starts at index 0.
    #[must_use]
    pub const fn new() -> Self {
        Self { written: 0, unread: 0, lost: 0 }
    }

    /// Takes the writer's position, below `LENGTH`, and whether the writer has wrapped.
    pub fn update(&mut self, position: usize, has_wrapped: bool) {
        let wrap = if has_wrapped { LENGTH } else { 0 };
        // A lower position without a wrap: the writer was restarted at index 0.
        let from = if has_wrapped || position >= self.written { self.written } else { 0 };
        self.unread = self.unread.saturating_add(position.saturating_add(wrap).saturating_sub(from));
        self.written = position;
        // A full buffer is discarded as well: its oldest byte is the next to be overwritten.
        if self.unread >= LENGTH {
            self.lost = self.lost.saturating_add(u32::try_from(self.unread).unwrap_or(u32::MAX));
            self.unread = 0;
        }
    }

    /// Takes the oldest unread byte and returns its index.
    pub fn take(&mut self) -> Option<usize> {
        let unread = self.unread;
        self.unread = unread.checked_sub(1)?;
        let index = self.written.saturating_add(LENGTH).saturating_sub(unread);
        index.checked_rem(LENGTH)
    }

    /// Number of bytes lost so far.
    #[must_use]
    pub const fn lost(&self) -> u32 {
        self.lost
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const LENGTH: usize = 16;

    /// Writer of ascending numbers.
    #[derive(Default)]
    struct Writer {
        buffer: [u32; LENGTH],
        written: u32,
        has_wrapped: bool,
    }

    impl Writer {
        fn write(&mut self, count: u32) {
            for _ in 0..count {
                self.buffer[self.written as usize % LENGTH] = self.written;
                self.written += 1;
                self.has_wrapped |= (self.written as usize).is_multiple_of(LENGTH);
            }
        }

        fn update(&mut self, ring: &mut DmaRing<LENGTH>) {
            ring.update(self.written as usize % LENGTH, core::mem::take(&mut self.has_wrapped));
        }
    }

    proptest! {
        #[test]
        fn every_byte_is_taken_once_in_order_or_counted_as_lost(
            rounds in prop::collection::vec((0..=LENGTH as u32, 0..LENGTH), 1..60),
        ) {
            let (mut writer, mut ring) = (Writer::default(), DmaRing::<LENGTH>::new());
            let (mut next, mut taken) = (0, 0);
            for (written, read) in rounds {
                writer.write(written);
                let before = ring.lost();
                writer.update(&mut ring);
                next += ring.lost() - before;
                for _ in 0..read {
                    let Some(index) = ring.take() else { break };
                    prop_assert_eq!(writer.buffer[index], next);
                    next += 1;
                    taken += 1;
                }
            }
            prop_assert_eq!(taken + ring.lost() + ring.unread as u32, writer.written);
        }
    }

    #[test]
    fn after_a_long_pause_the_count_is_too_low_and_later_bytes_are_read_correctly() {
        let (mut writer, mut ring) = (Writer::default(), DmaRing::<LENGTH>::new());
        writer.write(100);
        writer.update(&mut ring);
        assert_eq!((ring.lost(), ring.take()), (20, None), "one round is seen, six were written");
        writer.write(3);
        writer.update(&mut ring);
        let taken: Vec<_> = std::iter::from_fn(|| ring.take()).map(|index| writer.buffer[index]).collect();
        assert_eq!(taken, [100, 101, 102]);
    }

    #[test]
    fn a_restarted_writer_is_followed() {
        let mut ring = DmaRing::<LENGTH>::new();
        ring.update(9, false);
        assert_eq!(ring.take(), Some(0));
        ring.update(2, false);
        // The unread bytes are lost with the old position. The newest bytes are read once.
        assert!(std::iter::from_fn(|| ring.take()).count() <= 10);
        ring.update(3, false);
        assert_eq!(ring.take(), Some(2));
    }
}
