//! Alarms: a tracked quantity against its configured limit, with confidence and hysteresis.
//!
//! Raised when the quantity is above the limit by [`CONFIDENCE`] standard deviations (one-sided 95 %) in [`CONFIRM`] blocks in a row; ended
//! when it is below the end by as many deviations, as often in a row. So a quantity that stands exactly at the
//! limit raises no alarm, and one that is `2 CONFIDENCE` deviations above it does so within the confirmation in 95 of
//! 100 cases.
//!
//! | quantity | limit | end |
//! |---|---|---|
//! | radial clearance | `monitor.wear_limit_nm` | less `monitor.wear_hysteresis_nm` |
//! | friction level | `limits.friction_level_limit_per_mille`; 0 is none | a twentieth below it |

use crate::constants::Sum;
use link::track::{FrictionState, Wear};

/// Standard deviations that the quantity must be beyond a limit.
pub const CONFIDENCE: f32 = 1.645;
/// Blocks in a row that must agree: 0.2 s at 10 kHz.
pub const CONFIRM: u32 = 8;
/// Blocks before which nothing is said.
pub const ENOUGH: u32 = 16;
/// Friction level at which its alarm ends, as a share of its limit.
const FRICTION_END: f32 = 0.95;

/// An alarm.
#[derive(Clone, Debug)]
pub(super) struct Alarm {
    limit: f32,
    end: f32,
    raised: bool,
    agreeing: u32,
    times: u32,
}

impl Alarm {
    pub(super) fn constants(&self, sum: &mut Sum) {
        sum.floats(&[self.limit, self.end]);
    }

    /// For the clearance, m.
    pub(super) fn of_wear(limit_nm: u32, hysteresis_nm: u32) -> Self {
        let end_nm = limit_nm.saturating_sub(hysteresis_nm);
        Self::new(limit_nm as f32 * 1e-9, end_nm as f32 * 1e-9)
    }

    /// For the friction level.
    pub(super) fn of_friction(limit_per_mille: u32) -> Self {
        let limit = if limit_per_mille == 0 { f32::INFINITY } else { limit_per_mille as f32 * 1e-3 };
        Self::new(limit, limit * FRICTION_END)
    }

    const fn new(limit: f32, end: f32) -> Self {
        Self { limit, end, raised: false, agreeing: 0, times: 0 }
    }

    /// Takes the quantity after a block (`taken`) or leaves everything as it was.
    pub(super) fn update(&mut self, value: f32, variance: f32, taken: bool) {
        // Beyond the side that would change the state.
        let beyond = if self.raised { self.end - value } else { value - self.limit };
        let sure = (beyond > 0.0) & (beyond * beyond > (CONFIDENCE * CONFIDENCE) * variance);
        let agreeing = if sure { self.agreeing.wrapping_add(1) } else { 0 };
        let changes = taken & (agreeing >= CONFIRM);
        self.agreeing = if changes {
            0
        } else if taken {
            agreeing
        } else {
            self.agreeing
        };
        self.raised ^= changes;
        self.times = self.times.saturating_add(u32::from(changes & self.raised));
    }

    /// What is known of wear after so many blocks.
    pub(super) fn wear(&self, blocks: u32) -> Wear {
        if self.raised {
            Wear::Alarm
        } else if blocks < ENOUGH {
            Wear::Unknown
        } else {
            Wear::Below
        }
    }

    /// What is known of the friction level after so many blocks.
    pub(super) fn friction(&self, blocks: u32) -> FrictionState {
        match self.wear(blocks) {
            _ if self.limit.is_infinite() => FrictionState::NoLimit,
            Wear::Alarm => FrictionState::Alarm,
            Wear::Unknown => FrictionState::Unknown,
            Wear::Below => FrictionState::Below,
        }
    }

    /// Times that it was raised.
    pub(super) fn times(&self) -> u32 {
        self.times
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DEVIATION_M: f32 = 2e-6;

    fn after(alarm: &mut Alarm, clearance_m: f32, blocks: u32) -> Wear {
        for _ in 0..blocks {
            alarm.update(clearance_m, DEVIATION_M * DEVIATION_M, true);
        }
        alarm.wear(ENOUGH)
    }

    #[test]
    fn it_is_raised_with_confidence_and_ended_below_the_hysteresis() {
        let mut alarm = Alarm::of_wear(550_000, 20_000);
        assert_eq!(alarm.wear(0), Wear::Unknown);
        assert_eq!(after(&mut alarm, 552e-6, 100), Wear::Below, "above the limit, not sure");
        assert_eq!(after(&mut alarm, 554e-6, CONFIRM - 1), Wear::Below, "not confirmed");
        assert_eq!(after(&mut alarm, 550e-6, 1), Wear::Below);
        assert_eq!(after(&mut alarm, 554e-6, CONFIRM), Wear::Alarm);
        assert_eq!(after(&mut alarm, 535e-6, 100), Wear::Alarm, "inside the hysteresis");
        assert_eq!(after(&mut alarm, 526e-6, CONFIRM), Wear::Below);
        assert_eq!(alarm.times(), 1);
    }

    #[test]
    fn what_is_not_taken_changes_nothing() {
        let mut alarm = Alarm::of_wear(550_000, 20_000);
        for _ in 0..100 {
            alarm.update(1.0, 0.0, false);
        }
        assert_eq!(alarm.wear(ENOUGH), Wear::Below);
    }

    #[test]
    fn without_a_limit_no_friction_raises_an_alarm() {
        let (mut none, mut some) = (Alarm::of_friction(0), Alarm::of_friction(1_500));
        for _ in 0..100 {
            none.update(1e6, 0.0, true);
            some.update(1.6, 0.05 * 0.05, true);
        }
        assert_eq!((none.friction(ENOUGH), none.times()), (FrictionState::NoLimit, 0));
        assert_eq!((some.friction(ENOUGH), some.times()), (FrictionState::Alarm, 1));
        assert_eq!(Alarm::of_friction(1_500).friction(ENOUGH - 1), FrictionState::Unknown);
        for _ in 0..100 {
            some.update(1.43, 0.0, true);
        }
        assert_eq!(some.friction(ENOUGH), FrictionState::Alarm, "inside the hysteresis");
        for _ in 0..CONFIRM {
            some.update(1.42, 0.0, true);
        }
        assert_eq!(some.friction(ENOUGH), FrictionState::Below);
    }
}
