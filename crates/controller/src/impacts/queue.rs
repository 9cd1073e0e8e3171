//! Records of impacts that wait for the link service.

use heapless::Deque;
use link::{ImpactEnd, ImpactRecord};

use crate::integrity::{Checksum, Guarded, Words, words};

/// Largest number of records that wait for the service between two ticks.
pub(crate) const LENGTH: usize = 8;

impl Words for ImpactEnd {
    #[inline]
    fn add_to(&self, sum: &mut impl Checksum) {
        sum.add_word(*self as u32);
    }
}

words!(ImpactRecord {
    number,
    onset_sequence,
    onset_us,
    peak_us,
    duration_us,
    peak_force_n,
    peak_force_sd_n,
    approach_speed_m_s,
    separation_speed_m_s,
    energy_lost_j,
    flags,
    end,
});

/// Records that have not been sent, the oldest first.
#[derive(Clone, Debug, Default)]
pub(crate) struct Queue {
    waiting: Deque<Guarded<ImpactRecord>, LENGTH>,
    /// Number of the next record.
    next_number: u32,
}

impl Queue {
    /// Numbers a record and stores it. Returns false if there was no room: the record is lost, and
    /// its number is missing at the host.
    pub(crate) fn push(&mut self, record: ImpactRecord) -> bool {
        let number = self.next_number;
        self.next_number = number.wrapping_add(1);
        self.waiting.push_back(Guarded::new(ImpactRecord { number, ..record })).is_ok()
    }

    /// Takes the oldest record; an error if a bit of it has flipped.
    pub(crate) fn pop(&mut self) -> Option<Result<ImpactRecord, ()>> {
        let (record, is_corrupted) = self.waiting.pop_front()?.load();
        Some(if is_corrupted { Err(()) } else { Ok(record) })
    }

    /// Numbers the records of a new run from 0 on. Records of the last run stay.
    pub(crate) const fn restart_numbers(&mut self) {
        self.next_number = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_without_room_is_lost_and_leaves_a_gap_in_the_numbers() {
        let mut queue = Queue::default();
        let taken = (0..LENGTH + 2).filter(|_| queue.push(ImpactRecord::default())).count();
        assert_eq!(taken, LENGTH);
        assert_eq!(queue.pop().unwrap().unwrap().number, 0);
        assert!(queue.push(ImpactRecord::default()));
        let numbers: Vec<_> =
            core::iter::from_fn(|| queue.pop()).map(|record| record.unwrap().number).collect();
        assert_eq!(numbers, [1, 2, 3, 4, 5, 6, 7, 10]);
    }

    #[test]
    fn a_flipped_bit_of_a_waiting_record_is_detected() {
        let mut queue = Queue::default();
        queue.push(ImpactRecord { peak_force_n: 7.0, ..ImpactRecord::default() });
        queue.waiting.front_mut().unwrap().value_mut().onset_us ^= 1 << 9;
        assert_eq!(queue.pop(), Some(Err(())));
        assert_eq!(queue.pop(), None);
    }
}
