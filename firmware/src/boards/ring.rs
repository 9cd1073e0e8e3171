//! A circular buffer that a DMA controller writes and the link's loop reads: which bytes wait, and how many were lost.
//!
//! The writer never waits. [`Ring::look`] is told where it stands and whether it has come round the end since the look before; from both
//! follows how far it has gone. When it has gone over bytes that nobody took, all that wait are given up and counted: the link finds its
//! place at the next delimiter. The count is exact as long as looks are at most a round apart. After a longer pause it may be too low, and
//! bytes that were written over may be read: their frame fails its check.
//!
//! No registers here, so that it is tested on the host.

/// The reader's side of a buffer of `LENGTH` bytes.
#[derive(Clone, Debug)]
pub struct Ring<const LENGTH: usize> {
    written: usize,
    waiting: usize,
    lost: u32,
}

impl<const LENGTH: usize> Default for Ring<LENGTH> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const LENGTH: usize> Ring<LENGTH> {
    /// An empty buffer whose writer begins at the front.
    #[must_use]
    pub const fn new() -> Self {
        Self { written: 0, waiting: 0, lost: 0 }
    }

    /// Takes the place of the next byte to be written, below `LENGTH`, and whether the writer has come round.
    pub fn look(&mut self, place: usize, came_round: bool) {
        let beyond = if came_round { LENGTH } else { 0 };
        // Backwards without having come round: the writer was started anew at the front.
        let from = if came_round || place >= self.written { self.written } else { 0 };
        self.waiting = self.waiting.saturating_add(place.saturating_add(beyond).saturating_sub(from));
        self.written = place;
        // A full buffer is given up as well: its oldest byte is the next to be written over.
        if self.waiting >= LENGTH {
            self.lost = self.lost.saturating_add(u32::try_from(self.waiting).unwrap_or(u32::MAX));
            self.waiting = 0;
        }
    }

    /// Place of the oldest byte that waits; it counts as taken.
    pub fn take(&mut self) -> Option<usize> {
        let behind = self.waiting;
        self.waiting = behind.checked_sub(1)?;
        let place = self.written.saturating_add(LENGTH).saturating_sub(behind);
        place.checked_rem(LENGTH)
    }

    /// Bytes lost so far.
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

    /// A writer of counting bytes.
    #[derive(Default)]
    struct Writer {
        buffer: [u32; LENGTH],
        written: u32,
        came_round: bool,
    }

    impl Writer {
        fn write(&mut self, count: u32) {
            for _ in 0..count {
                self.buffer[self.written as usize % LENGTH] = self.written;
                self.written += 1;
                self.came_round |= (self.written as usize).is_multiple_of(LENGTH);
            }
        }

        fn seen_by(&mut self, ring: &mut Ring<LENGTH>) {
            ring.look(self.written as usize % LENGTH, core::mem::take(&mut self.came_round));
        }
    }

    proptest! {
        #[test]
        fn every_byte_is_taken_once_in_order_or_counted_as_lost(
            rounds in prop::collection::vec((0..=LENGTH as u32, 0..LENGTH), 1..60),
        ) {
            let (mut writer, mut ring) = (Writer::default(), Ring::<LENGTH>::new());
            let (mut next, mut taken) = (0, 0);
            for (written, read) in rounds {
                writer.write(written);
                let before = ring.lost();
                writer.seen_by(&mut ring);
                next += ring.lost() - before;
                for _ in 0..read {
                    let Some(place) = ring.take() else { break };
                    prop_assert_eq!(writer.buffer[place], next);
                    next += 1;
                    taken += 1;
                }
            }
            prop_assert_eq!(taken + ring.lost() + ring.waiting as u32, writer.written);
        }
    }

    #[test]
    fn after_a_long_pause_too_few_are_counted_and_what_follows_is_whole() {
        let (mut writer, mut ring) = (Writer::default(), Ring::<LENGTH>::new());
        writer.write(100);
        writer.seen_by(&mut ring);
        assert_eq!((ring.lost(), ring.take()), (20, None), "one round is seen, six were written");
        writer.write(3);
        writer.seen_by(&mut ring);
        let taken: Vec<_> = std::iter::from_fn(|| ring.take()).map(|place| writer.buffer[place]).collect();
        assert_eq!(taken, [100, 101, 102]);
    }

    #[test]
    fn a_writer_started_anew_is_followed() {
        let mut ring = Ring::<LENGTH>::new();
        ring.look(9, false);
        assert_eq!(ring.take(), Some(0));
        ring.look(2, false);
        // What waited is gone with the old buffer's place; the newest bytes are what is read, and none twice.
        assert!(std::iter::from_fn(|| ring.take()).count() <= 10);
        ring.look(3, false);
        assert_eq!(ring.take(), Some(2));
    }
}
