//! Pace of the estimates: the event that starts them, and the period of the timer.

/// Event that starts the estimate of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pacing {
    /// The timer: samples wait for its tick.
    Timer,
    /// The host: the service estimates each sample when it arrives, so that the instruction count
    /// of a tick repeats exactly. Only the emulator does this.
    Lockstep,
}

/// Periods of a timer that loads a new period when it has counted the old one, us.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    /// Time from the last tick to the next one.
    current_us: u32,
    /// Time from the next tick to the one after it.
    next_us: u32,
}

impl Pace {
    /// Creates the pace of a timer that has just started.
    #[must_use]
    pub const fn new(period_us: u32) -> Self {
        Self { current_us: period_us, next_us: period_us }
    }

    /// Notes a tick. Returns the time since the tick before, us.
    pub const fn advance(&mut self) -> u32 {
        let passed_us = self.current_us;
        self.current_us = self.next_us;
        passed_us
    }

    /// Returns the time from the last tick to the next one, us.
    #[must_use]
    pub const fn current_us(&self) -> u32 {
        self.current_us
    }

    /// Changes the period from the next tick on. Returns true if the timer must load it, and
    /// whether the time to the next tick is that period already.
    pub const fn set_period(&mut self, period_us: u32) -> (bool, bool) {
        let is_new = self.next_us != period_us;
        self.next_us = period_us;
        (is_new, self.current_us == period_us)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_tick_gets_the_time_that_passed_and_samples_wait_for_the_new_period() {
        // A timer that counts, and the ticks at which it wraps.
        let (mut pace, mut loaded_us, mut counted_us) = (Pace::new(100), 100, 100);
        let (mut time_us, mut uptime_us) = (0, 0);
        let mut sampled = vec![];
        for tick in 0..30 {
            time_us += counted_us;
            counted_us = loaded_us;
            uptime_us += pace.advance();
            assert_eq!(uptime_us, time_us, "tick {tick}");
            let period_us = if (5..20).contains(&tick) { 300 } else { 100 };
            let (is_new, is_paced) = pace.set_period(period_us);
            if is_new {
                loaded_us = period_us;
            }
            if is_paced {
                sampled.push((period_us, uptime_us));
            }
        }
        assert_eq!(sampled.len(), 28, "one tick at each change has no sample");
        for pair in sampled.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            assert_eq!(pair[1].1 - pair[0].1, pair[0].0);
        }
    }
}
