//! Patterns of the board's indicator light.
//!
//! | light | meaning |
//! |---|---|
//! | off | no power, or the core does not run |
//! | one short flash per second | waiting to be configured |
//! | half a second on, half a second off | estimating |
//! | five flashes per second | waiting after a fault, a missed check-in or the watchdog |

use link::start::{ResetReason, StartReport};

/// Condition that the light shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// Waiting to be configured.
    Waiting,
    /// Estimating.
    Estimating,
    /// Waiting after a fault.
    Faulted,
}

/// Returns the condition to show.
#[must_use]
pub const fn shown(start: &StartReport, estimating: bool) -> Shown {
    match (estimating, start.reason) {
        (true, _) => Shown::Estimating,
        (false, ResetReason::Fault | ResetReason::Starved | ResetReason::Watchdog) => Shown::Faulted,
        (false, _) => Shown::Waiting,
    }
}

/// Decides whether the light is on at an uptime, us modulo 2^32. At the wrap, once in 71 minutes,
/// one flash is cut short.
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
    fn each_state_has_a_different_pattern() {
        let share = |shown| (0..1_000).filter(|ms| lit(shown, ms * 1_000)).count();
        assert_eq!([Shown::Waiting, Shown::Estimating, Shown::Faulted].map(share), [50, 500, 500]);
        let flashes = |shown| {
            (1..1_000).filter(|ms| lit(shown, ms * 1_000) && !lit(shown, (ms - 1) * 1_000)).count() + 1
        };
        assert_eq!([Shown::Waiting, Shown::Estimating, Shown::Faulted].map(flashes), [1, 1, 5]);
    }

    #[test]
    fn a_fault_is_shown_until_a_configuration() {
        let start = StartReport { reason: ResetReason::Starved, ..StartReport::default() };
        assert_eq!(shown(&start, false), Shown::Faulted);
        assert_eq!(shown(&start, true), Shown::Estimating);
        assert_eq!(shown(&StartReport::default(), false), Shown::Waiting);
    }
}
