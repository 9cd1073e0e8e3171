//! Wear alarm: the tracked clearance against the configured limit, with confidence and hysteresis.
//!
//! Raised when the clearance is above the limit by [`CONFIDENCE`] standard deviations (one-sided 95 %) in [`CONFIRM`] blocks in a row; ended
//! when it is below the limit less the hysteresis by as many deviations, as often in a row. So a clearance that stands exactly at the
//! limit raises no alarm, and one that is `2 CONFIDENCE` deviations above it does so within the confirmation in 95 of
//! 100 cases.

use link::track::Wear;

/// Standard deviations that the clearance must be beyond a limit.
pub const CONFIDENCE: f32 = 1.645;
/// Blocks in a row that must agree: 0.2 s at 10 kHz.
pub const CONFIRM: u32 = 8;
/// Blocks before which nothing is said.
pub const ENOUGH: u32 = 16;

/// The alarm.
#[derive(Clone, Debug)]
pub(super) struct WearAlarm {
    limit_m: f32,
    end_m: f32,
    raised: bool,
    agreeing: u32,
    times: u32,
}

impl WearAlarm {
    pub(super) fn new(limit_nm: u32, hysteresis_nm: u32) -> Self {
        Self {
            limit_m: limit_nm as f32 * 1e-9,
            end_m: limit_nm.saturating_sub(hysteresis_nm) as f32 * 1e-9,
            raised: false,
            agreeing: 0,
            times: 0,
        }
    }

    /// Takes the clearance after a block (`taken`) or leaves everything as it was.
    pub(super) fn update(&mut self, clearance_m: f32, variance_m2: f32, taken: bool) {
        // Beyond the side that would change the state.
        let beyond_m = if self.raised { self.end_m - clearance_m } else { clearance_m - self.limit_m };
        let sure = (beyond_m > 0.0) & (beyond_m * beyond_m > (CONFIDENCE * CONFIDENCE) * variance_m2);
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

    /// What is known after so many blocks.
    pub(super) fn state(&self, blocks: u32) -> Wear {
        if self.raised {
            Wear::Alarm
        } else if blocks < ENOUGH {
            Wear::Unknown
        } else {
            Wear::Below
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

    fn after(alarm: &mut WearAlarm, clearance_m: f32, blocks: u32) -> Wear {
        for _ in 0..blocks {
            alarm.update(clearance_m, DEVIATION_M * DEVIATION_M, true);
        }
        alarm.state(ENOUGH)
    }

    #[test]
    fn it_is_raised_with_confidence_and_ended_below_the_hysteresis() {
        let mut alarm = WearAlarm::new(550_000, 20_000);
        assert_eq!(alarm.state(0), Wear::Unknown);
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
        let mut alarm = WearAlarm::new(550_000, 20_000);
        for _ in 0..100 {
            alarm.update(1.0, 0.0, false);
        }
        assert_eq!(alarm.state(ENOUGH), Wear::Below);
    }
}
