//! Pace of a live view: assigns a wall time to every simulated time.
//!
//! Speeds are in simulated seconds per second, 0.001 to 1000.

use crate::cli::error::CliError;
use std::time::{Duration, Instant};

/// Minimum time for which a run without a terminal is paused: shorter pauses would only cost time.
const MIN_PAUSE: Duration = Duration::from_millis(2);

/// Assignment of wall times to simulated times. It starts with the first sample.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pace {
    speed: f64,
    started: Option<Instant>,
}

impl Pace {
    /// Checks the speed.
    ///
    /// # Errors
    ///
    /// The speed is out of range.
    pub(crate) fn new(speed: f64) -> Result<Self, CliError> {
        if !(1e-3..=1e3).contains(&speed) {
            return Err(CliError::Input(format!("--watch-speed: found {speed}; expected 0.001 to 1000")));
        }
        Ok(Self { speed, started: None })
    }

    /// Returns the simulated seconds per second.
    pub(crate) const fn speed(&self) -> f64 {
        self.speed
    }

    /// Returns the wall time that belongs to a simulated time in s.
    pub(crate) fn due(&mut self, time_s: f64) -> Instant {
        let started = *self.started.get_or_insert_with(Instant::now);
        started + Duration::try_from_secs_f64(time_s / self.speed).unwrap_or_default()
    }
}

/// Waits until `due`, or not at all if that is too near.
pub(crate) fn wait_until(due: Instant) {
    let left = due.saturating_duration_since(Instant::now());
    if left >= MIN_PAUSE {
        std::thread::sleep(left);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_speed_of_two_halves_the_time_and_the_first_sample_starts_it() {
        let mut pace = Pace::new(2.0).unwrap();
        let first = pace.due(0.0);
        std::thread::yield_now();
        assert_eq!(pace.due(3.0) - first, Duration::from_millis(1500));
        assert_eq!(Pace::new(0.5).unwrap().due(0.0).elapsed().as_secs(), 0);
    }

    #[test]
    fn a_speed_out_of_range_is_refused() {
        for speed in [0.0, 9e-4, 1001.0, f64::NAN, -1.0] {
            assert!(Pace::new(speed).unwrap_err().to_string().contains("expected 0.001 to 1000"));
        }
        assert!(Pace::new(1e-3).is_ok() && Pace::new(1e3).is_ok());
    }

    #[test]
    fn a_time_that_has_passed_is_not_waited_for() {
        let start = Instant::now();
        wait_until(start);
        wait_until(start + Duration::from_millis(20));
        assert!(start.elapsed() >= Duration::from_millis(20));
    }
}
