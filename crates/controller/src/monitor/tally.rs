//! Twenty-eight saturating counters whose cost does not depend on what they count.
//!
//! The events of a sample are the bits of a word. They are added to pending counts of five bits,
//! stored bit by bit: word `i` of the pending counts holds bit `i` of every count, so all counts
//! are incremented by one addition with carry. Each sample moves the pending count of one lane to
//! its total. Every lane is moved once in 28 samples, so five bits do not overflow.

/// Counters.
const LANES: u32 = 28;
/// Bits of a pending count.
const BITS: usize = 5;

/// The counters.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    pending: [u32; BITS],
    totals: [u32; LANES as usize],
    /// Lane whose pending count is moved next.
    next: u32,
}

impl Tally {
    /// Counts every event whose bit is set; bits from [`LANES`] on are ignored.
    pub(super) fn add(&mut self, events: u32) {
        let lane = self.next & 31;
        let others = !(1_u32 << lane);
        let mut carry = events;
        let mut pending = 0;
        for (word, bit) in self.pending.iter_mut().zip(0_u32..) {
            let sum = *word ^ carry;
            carry &= *word;
            pending |= (sum >> lane & 1) << bit;
            *word = sum & others;
        }
        if let Some(total) = self.totals.get_mut(lane as usize) {
            *total = total.saturating_add(pending);
        }
        self.next = if lane == LANES - 1 { 0 } else { lane.wrapping_add(1) };
    }

    /// Returns the number of times an event happened.
    pub(super) fn count(&self, lane: u32) -> u32 {
        let pending = (self.pending.iter().zip(0_u32..))
            .fold(0, |pending, (word, bit)| pending | (word.wrapping_shr(lane) & 1) << bit);
        self.totals.get(lane as usize).map_or(0, |total| total.saturating_add(pending))
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
                    let past = events.iter().take(index + 1);
                    let expected = past.filter(|word| *word >> lane & 1 == 1).count();
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
