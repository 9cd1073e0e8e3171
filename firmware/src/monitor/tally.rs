//! Twenty-eight saturating counters that cost the same whatever they count.
//!
//! A sample's events come as the bits of a word. Four bits at a time are spread over the four bytes of a word of short counts (one
//! multiplication), and each sample moves one short count to its long one: within 28 samples every event has had its turn, so no
//! byte overflows.

/// Counters.
const LANES: u32 = 4 * WORDS as u32;
/// Words of four short counts.
const WORDS: usize = 7;
/// Brings bit `i` of four to bit `8 i`.
const SPREAD: u32 = 1 | 1 << 7 | 1 << 14 | 1 << 21;
const LOWEST_BITS: u32 = 0x0101_0101;

/// The counters.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    short: [u32; WORDS],
    long: [u32; LANES as usize],
    turn: u32,
}

impl Tally {
    /// Counts every event whose bit is set; bits from [`LANES`] on are no events.
    pub(super) fn add(&mut self, events: u32) {
        for (short, place) in self.short.iter_mut().zip(0_u32..) {
            let four = events.wrapping_shr(place.wrapping_mul(4)) & 0xf;
            *short = short.wrapping_add(four.wrapping_mul(SPREAD) & LOWEST_BITS);
        }
        let lane = self.turn;
        let shift = lane % 4 * 8;
        if let (Some(short), Some(long)) =
            (self.short.get_mut(lane as usize / 4), self.long.get_mut(lane as usize))
        {
            let pending = short.wrapping_shr(shift) & 0xff;
            *short = short.wrapping_sub(pending.wrapping_shl(shift));
            *long = long.saturating_add(pending);
        }
        self.turn = if lane == LANES - 1 { 0 } else { lane.wrapping_add(1) };
    }

    /// How often an event happened.
    pub(super) fn count(&self, lane: u32) -> u32 {
        let short =
            self.short.get(lane as usize / 4).map_or(0, |short| short.wrapping_shr(lane % 4 * 8) & 0xff);
        self.long.get(lane as usize).map_or(0, |long| long.saturating_add(short))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn it_counts_every_event(events in proptest::collection::vec(any::<u32>(), 0..200)) {
            let mut tally = Tally::default();
            for (index, word) in events.iter().enumerate() {
                tally.add(*word);
                for lane in 0..LANES {
                    let expected = events.iter().take(index + 1).filter(|word| *word >> lane & 1 == 1).count();
                    prop_assert_eq!(tally.count(lane) as usize, expected);
                }
            }
        }
    }

    #[test]
    fn it_counts_every_sample_of_a_lasting_event() {
        let mut tally = Tally::default();
        for _ in 0..10_000 {
            tally.add(u32::MAX);
        }
        assert!((0..LANES).all(|lane| tally.count(lane) == 10_000));
    }
}
