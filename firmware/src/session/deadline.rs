//! The deadline of a tick: the work on a sample, its frame included, must be done within the sample period.
//!
//! A tick that took longer is counted once and its estimate marked as stale; so many of them in a row as the configuration says trip the
//! controller. Before the frame is written its duration is not known: the previous one's is taken, which is the same work.
//!
//! A budget of 0 means that nothing is watched: natively there is no counter, and the emulator's lockstep has no time.

use core::hash::Hash;

use crate::constants::Sum;

/// Watches one run.
#[derive(Clone, Debug)]
pub(super) struct Deadline {
    budget_ticks: u32,
    trip_count: u16,
    in_a_row: u16,
    /// Timer ticks of the last frame, and of the whole last tick.
    frame_ticks: u32,
    whole_ticks: u32,
    tripped: bool,
}

impl Deadline {
    pub(super) const fn new(budget_ticks: u32, trip_count: u16) -> Self {
        Self { budget_ticks, trip_count, in_a_row: 0, frame_ticks: 0, whole_ticks: 0, tripped: false }
    }

    pub(super) fn constants(&self, sum: &mut Sum) {
        (self.budget_ticks, self.trip_count).hash(sum);
    }

    /// Takes the ticks that a sample took up to its frame; returns whether it is late.
    pub(super) fn is_late(&mut self, elapsed: u32) -> bool {
        let late = self.budget_ticks != 0 && elapsed.saturating_add(self.frame_ticks) > self.budget_ticks;
        self.in_a_row = if late { self.in_a_row.saturating_add(1) } else { 0 };
        late
    }

    /// Trips if that was one late sample too many; returns whether it just did.
    pub(super) fn trips(&mut self) -> bool {
        let trips = !self.tripped && self.trip_count != 0 && self.in_a_row >= self.trip_count;
        self.tripped |= trips;
        trips
    }

    /// Takes the ticks of a whole tick, of which `elapsed` had passed before its frame.
    pub(super) fn finished(&mut self, elapsed: u32, whole: u32) {
        self.frame_ticks = whole.saturating_sub(elapsed);
        self.whole_ticks = whole;
    }

    /// Timer ticks of the last whole tick; 0 before the first.
    pub(super) const fn whole_ticks(&self) -> u32 {
        self.whole_ticks
    }

    /// Starts over after a trip.
    pub(super) const fn clear(&mut self) {
        self.tripped = false;
        self.in_a_row = 0;
    }

    pub(super) const fn tripped(&self) -> bool {
        self.tripped
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lateness(watch: &mut Deadline, elapsed: &[u32]) -> Vec<(bool, bool)> {
        elapsed.iter().map(|&elapsed| (watch.is_late(elapsed), watch.trips())).collect()
    }

    #[test]
    fn it_trips_at_the_given_number_in_a_row_and_once() {
        let mut watch = Deadline::new(100, 3);
        let (good, late) = ((false, false), (true, false));
        let expected = [good, late, late, good, late, late, (true, true), late];
        assert_eq!(lateness(&mut watch, &[100, 101, 101, 100, 101, 101, 101, 101]), expected);
        assert!(watch.tripped());
    }

    #[test]
    fn the_frame_counts_too() {
        let mut watch = Deadline::new(100, 0);
        assert!(!watch.is_late(95));
        watch.finished(95, 105);
        assert_eq!(watch.whole_ticks(), 105);
        assert!(!watch.is_late(90));
        assert!(watch.is_late(91));
    }

    #[test]
    fn without_a_count_it_never_trips_and_without_a_budget_nothing_is_late() {
        let mut watch = Deadline::new(100, 0);
        assert!(lateness(&mut watch, &[200; 1000]).iter().all(|&(late, trips)| late && !trips));
        let mut unwatched = Deadline::new(0, 1);
        assert!(lateness(&mut unwatched, &[u32::MAX; 10]).iter().all(|&(late, trips)| !late && !trips));
    }
}
