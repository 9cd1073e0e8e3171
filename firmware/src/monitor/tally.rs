//! Thirty-two saturating counters that cost the same whatever they count.
//!
//! A sample's events come as the bits of a word. They are added to bit-sliced counters (plane `i` holds bit `i` of every count), and
//! each sample moves the short count of one lane to its long one: within 32 samples every lane has had its turn, so six planes
//! never overflow.

/// Counters.
const LANES: u32 = 32;
/// Planes: a lane counts up to 32 between its turns.
const PLANES: usize = 6;

/// The counters.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    planes: [u32; PLANES],
    counts: [u32; LANES as usize],
    turn: u32,
}

impl Tally {
    /// Counts every event whose bit is set.
    pub(super) fn add(&mut self, events: u32) {
        let lane = self.turn;
        let mut carry = events;
        let mut pending = 0;
        for (plane, power) in self.planes.iter_mut().zip(0_u32..) {
            let sum = *plane ^ carry;
            carry &= *plane;
            let bit = sum.wrapping_shr(lane) & 1;
            pending |= bit.wrapping_shl(power);
            *plane = sum ^ bit.wrapping_shl(lane);
        }
        if let Some(count) = self.counts.get_mut(lane as usize) {
            *count = count.saturating_add(pending);
        }
        self.turn = lane.wrapping_add(1) % LANES;
    }

    /// How often an event happened.
    pub(super) fn count(&self, lane: u32) -> u32 {
        self.counts.get(lane as usize).map_or(0, |count| count.saturating_add(self.pending(lane)))
    }

    fn pending(&self, lane: u32) -> u32 {
        let planes = self.planes.iter().zip(0_u32..);
        planes.fold(0, |pending, (plane, power)| pending | (plane.wrapping_shr(lane) & 1).wrapping_shl(power))
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
                    let expected = events[..=index].iter().filter(|word| *word >> lane & 1 == 1).count();
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
