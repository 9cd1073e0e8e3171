//! Alarms: a tracked quantity is compared with its limit, with confidence and hysteresis.
//!
//! An alarm is raised if the quantity is above the limit by [`CONFIDENCE`] standard deviations
//! (one-sided 95 %) in [`CONFIRM`] successive comparisons. It ends if the quantity is below the end
//! by as many deviations in as many comparisons. So a quantity exactly at the limit raises no
//! alarm, and one that is `2 CONFIDENCE` deviations above it raises it within the confirmation in
//! 95 of 100 cases.
//!
//! | quantity | limit | end |
//! |---|---|---|
//! | radial clearance | `monitor.wear_limit_nm` | less `monitor.wear_hysteresis_nm` |
//! | friction level | `limits.friction_level_limit_per_mille`; 0 is none | a twentieth below it |

use crate::integrity::words;
use link::track::{FrictionState, Wear};

/// Standard deviations by which the quantity must exceed a limit.
pub(super) const CONFIDENCE: f32 = 1.645;
/// Successive comparisons that must agree: 0.2 s at 10 kHz.
pub(super) const CONFIRM: u32 = 8;
/// Comparisons before which the state is unknown.
pub(super) const ENOUGH: u32 = 16;
/// Friction level at which its alarm ends, as a share of its limit.
const FRICTION_END: f32 = 0.95;

/// Limits of an alarm.
#[derive(Clone, Debug)]
pub(super) struct Alarm {
    limit: f32,
    /// Value below which the alarm ends.
    end: f32,
}
words!(Alarm { limit, end });

/// State of an [`Alarm`].
#[derive(Clone, Debug, Default)]
pub(super) struct AlarmState {
    is_raised: bool,
    /// Successive comparisons beyond the limit, or below the end while raised.
    agreeing: u32,
    /// Number of times that it was raised.
    count: u32,
}

impl Alarm {
    /// Alarm of the clearance, m.
    pub(super) fn for_wear(limit_nm: u32, hysteresis_nm: u32) -> Self {
        let end_nm = limit_nm.saturating_sub(hysteresis_nm);
        Self::new(limit_nm as f32 * 1e-9, end_nm as f32 * 1e-9)
    }

    /// Alarm of the friction level.
    pub(super) fn for_friction(limit_per_mille: u16) -> Self {
        let limit = if limit_per_mille == 0 { f32::INFINITY } else { f32::from(limit_per_mille) * 1e-3 };
        Self::new(limit, limit * FRICTION_END)
    }

    const fn new(limit: f32, end: f32) -> Self {
        Self { limit, end }
    }

    /// Compares the quantity; changes nothing unless the comparison counts.
    pub(super) fn update(&self, state: &mut AlarmState, value: f32, variance: f32, counts: bool) {
        // Distance beyond the side that would change the state.
        let beyond = if state.is_raised { self.end - value } else { value - self.limit };
        let is_sure = (beyond > 0.0) & (beyond * beyond > (CONFIDENCE * CONFIDENCE) * variance);
        let agreeing = if is_sure { state.agreeing.wrapping_add(1) } else { 0 };
        let changes = counts & (agreeing >= CONFIRM);
        state.agreeing = if changes {
            0
        } else if counts {
            agreeing
        } else {
            state.agreeing
        };
        state.is_raised ^= changes;
        state.count = state.count.saturating_add(u32::from(changes & state.is_raised));
    }

    /// The state of the friction alarm after so many comparisons.
    pub(super) fn friction(&self, state: &AlarmState, comparisons: u32) -> FrictionState {
        match state.wear(comparisons) {
            _ if self.limit.is_infinite() => FrictionState::NoLimit,
            Wear::Alarm => FrictionState::Alarm,
            Wear::Unknown => FrictionState::Unknown,
            Wear::Below => FrictionState::Below,
        }
    }
}

impl AlarmState {
    /// The state of the wear alarm after so many comparisons.
    pub(super) fn wear(&self, comparisons: u32) -> Wear {
        if self.is_raised {
            Wear::Alarm
        } else if comparisons < ENOUGH {
            Wear::Unknown
        } else {
            Wear::Below
        }
    }

    /// Number of times that the alarm was raised.
    pub(super) fn count(&self) -> u32 {
        self.count
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DEVIATION_M: f32 = 2e-6;

    /// An alarm with its state.
    struct TestAlarm(Alarm, AlarmState);

    impl TestAlarm {
        fn wear() -> Self {
            Self(Alarm::for_wear(550_000, 20_000), AlarmState::default())
        }

        fn friction(limit_per_mille: u16) -> Self {
            Self(Alarm::for_friction(limit_per_mille), AlarmState::default())
        }

        fn update(&mut self, value: f32, variance: f32, counts: bool) {
            self.0.update(&mut self.1, value, variance, counts);
        }

        fn friction_state(&self, blocks: u32) -> FrictionState {
            self.0.friction(&self.1, blocks)
        }
    }

    fn after(alarm: &mut TestAlarm, clearance_m: f32, blocks: u32) -> Wear {
        for _ in 0..blocks {
            alarm.update(clearance_m, DEVIATION_M * DEVIATION_M, true);
        }
        alarm.1.wear(ENOUGH)
    }

    #[test]
    fn it_is_raised_with_confidence_and_ended_below_the_hysteresis() {
        let mut alarm = TestAlarm::wear();
        assert_eq!(alarm.1.wear(0), Wear::Unknown);
        assert_eq!(after(&mut alarm, 552e-6, 100), Wear::Below, "above the limit, not sure");
        assert_eq!(after(&mut alarm, 554e-6, CONFIRM - 1), Wear::Below, "not confirmed");
        assert_eq!(after(&mut alarm, 550e-6, 1), Wear::Below);
        assert_eq!(after(&mut alarm, 554e-6, CONFIRM), Wear::Alarm);
        assert_eq!(after(&mut alarm, 535e-6, 100), Wear::Alarm, "inside the hysteresis");
        assert_eq!(after(&mut alarm, 526e-6, CONFIRM), Wear::Below);
        assert_eq!(alarm.1.count(), 1);
    }

    #[test]
    fn comparisons_that_do_not_count_change_nothing() {
        let mut alarm = TestAlarm::wear();
        for _ in 0..100 {
            alarm.update(1.0, 0.0, false);
        }
        assert_eq!(alarm.1.wear(ENOUGH), Wear::Below);
    }

    #[test]
    fn without_a_limit_no_friction_raises_an_alarm() {
        let (mut none, mut some) = (TestAlarm::friction(0), TestAlarm::friction(1_500));
        for _ in 0..100 {
            none.update(1e6, 0.0, true);
            some.update(1.6, 0.05 * 0.05, true);
        }
        assert_eq!((none.friction_state(ENOUGH), none.1.count()), (FrictionState::NoLimit, 0));
        assert_eq!((some.friction_state(ENOUGH), some.1.count()), (FrictionState::Alarm, 1));
        assert_eq!(TestAlarm::friction(1_500).friction_state(ENOUGH - 1), FrictionState::Unknown);
        for _ in 0..100 {
            some.update(1.43, 0.0, true);
        }
        assert_eq!(some.friction_state(ENOUGH), FrictionState::Alarm, "inside the hysteresis");
        for _ in 0..CONFIRM {
            some.update(1.42, 0.0, true);
        }
        assert_eq!(some.friction_state(ENOUGH), FrictionState::Below);
    }
}
