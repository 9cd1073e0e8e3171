//! Deadline of a tick: the work on a sample including its frame must end within the sample period.
//!
//! A late tick is counted once and its estimate is marked as stale. The configured number of
//! consecutive late ticks trips the controller. The time of the frame is not known before it is
//! encoded: that of the previous frame is used, which is the same work.
//!
//! A budget of 0 disables the watch: natively there is no counter, and the emulator's lockstep has
//! no time.

use crate::integrity::Words;
use link::crc32::Digest;

/// Watches one run.
#[derive(Clone, Debug)]
pub(super) struct Deadline {
    budget_ticks: u32,
    trip_count: u16,
    in_a_row: u16,
    /// Timer ticks of the last frame, and of the complete last tick.
    frame_ticks: u32,
    total_ticks: u32,
    tripped: bool,
}

impl Deadline {
    pub(super) const fn new(budget_ticks: u32, trip_count: u16) -> Self {
        Self { budget_ticks, trip_count, in_a_row: 0, frame_ticks: 0, total_ticks: 0, tripped: false }
    }

    /// Adds the constants to the CRC of the configuration.
    pub(super) fn add_config_to(&self, crc: &mut Digest) {
        self.budget_ticks.add_to(crc);
        self.trip_count.add_to(crc);
    }

    /// Takes the ticks that a sample took up to its frame; returns whether it is late.
    pub(super) fn record_elapsed(&mut self, elapsed: u32) -> bool {
        let late = self.budget_ticks != 0 && elapsed.saturating_add(self.frame_ticks) > self.budget_ticks;
        self.in_a_row = if late { self.in_a_row.saturating_add(1) } else { 0 };
        late
    }

    /// Trips if that was one late sample too many; returns whether it just did.
    pub(super) fn trip_if_due(&mut self) -> bool {
        let trips = !self.tripped && self.trip_count != 0 && self.in_a_row >= self.trip_count;
        self.tripped |= trips;
        trips
    }

    /// Takes the ticks of a complete tick, of which `elapsed` had passed before its frame.
    pub(super) fn finish(&mut self, elapsed: u32, total: u32) {
        self.frame_ticks = total.saturating_sub(elapsed);
        self.total_ticks = total;
    }

    /// Timer ticks of the last complete tick; 0 before the first.
    pub(super) const fn total_ticks(&self) -> u32 {
        self.total_ticks
    }

    /// Starts over after a trip.
    pub(super) const fn clear(&mut self) {
        self.tripped = false;
        self.in_a_row = 0;
    }

    pub(super) const fn is_tripped(&self) -> bool {
        self.tripped
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lateness(watch: &mut Deadline, elapsed: &[u32]) -> Vec<(bool, bool)> {
        elapsed.iter().map(|&elapsed| (watch.record_elapsed(elapsed), watch.trip_if_due())).collect()
    }

    #[test]
    fn it_trips_at_the_given_number_in_a_row_and_once() {
        let mut watch = Deadline::new(100, 3);
        let (good, late) = ((false, false), (true, false));
        let expected = [good, late, late, good, late, late, (true, true), late];
        assert_eq!(lateness(&mut watch, &[100, 101, 101, 100, 101, 101, 101, 101]), expected);
        assert!(watch.is_tripped());
    }

    #[test]
    fn the_frame_counts_too() {
        let mut watch = Deadline::new(100, 0);
        assert!(!watch.record_elapsed(95));
        watch.finish(95, 105);
        assert_eq!(watch.total_ticks(), 105);
        assert!(!watch.record_elapsed(90));
        assert!(watch.record_elapsed(91));
    }

    #[test]
    fn without_a_count_it_never_trips_and_without_a_budget_nothing_is_late() {
        let mut watch = Deadline::new(100, 0);
        assert!(lateness(&mut watch, &[200; 1000]).iter().all(|&(late, trips)| late && !trips));
        let mut unwatched = Deadline::new(0, 1);
        assert!(lateness(&mut unwatched, &[u32::MAX; 10]).iter().all(|&(late, trips)| !late && !trips));
    }
}
