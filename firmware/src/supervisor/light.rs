//! What the board's one light shows.
//!
//! | light | meaning |
//! |---|---|
//! | dark | no power, or the core does not run |
//! | one short flash a second | waits to be configured |
//! | half a second on, half off | estimates, nothing to remark |
//! | five flashes a second | the last start was a fault or a missed check-in; until configured |

use link::start::{ResetReason, StartReport};

/// What there is to show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// Waits to be configured.
    Waiting,
    /// Estimates.
    Estimating,
    /// Waits after a fault.
    Faulted,
}

/// What to show.
#[must_use]
pub const fn shown(start: &StartReport, estimating: bool) -> Shown {
    match (estimating, start.reason) {
        (true, _) => Shown::Estimating,
        (false, ResetReason::Fault | ResetReason::Starved | ResetReason::Watchdog) => Shown::Faulted,
        (false, _) => Shown::Waiting,
    }
}

/// Whether the light is on at an uptime, us modulo 2^32. At the wrap, once in 71 minutes, one flash is cut short.
#[must_use]
pub const fn lit(shown: Shown, now_us: u32) -> bool {
    let (period_us, on_us) = match shown {
        Shown::Waiting => (1_000_000, 50_000),
        Shown::Estimating => (1_000_000, 500_000),
        Shown::Faulted => (200_000, 100_000),
    };
    now_us % period_us < on_us
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_state_has_a_pattern_of_its_own() {
        let share = |shown| (0..1_000).filter(|ms| lit(shown, ms * 1_000)).count();
        assert_eq!([Shown::Waiting, Shown::Estimating, Shown::Faulted].map(share), [50, 500, 500]);
        let flashes = |shown| {
            (1..1_000).filter(|ms| lit(shown, ms * 1_000) && !lit(shown, (ms - 1) * 1_000)).count() + 1
        };
        assert_eq!([Shown::Waiting, Shown::Estimating, Shown::Faulted].map(flashes), [1, 1, 5]);
    }

    #[test]
    fn a_fault_shows_until_somebody_configures() {
        let start = StartReport { reason: ResetReason::Starved, fault: None };
        assert_eq!(shown(&start, false), Shown::Faulted);
        assert_eq!(shown(&start, true), Shown::Estimating);
        assert_eq!(shown(&StartReport::default(), false), Shown::Waiting);
    }
}
