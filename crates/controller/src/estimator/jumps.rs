//! Samples after a jump: a sensor that has jumped is not trusted until it has returned, or until a
//! stuck one would have been found.

use crate::integrity::words;
use link::SensorFrame;

/// Samples for which a sensor is not trusted after a jump: longer than the default time after which
/// an unchanged code counts as stuck.
const SUSPECT_SAMPLES: u32 = 128;
/// Distance from the last trusted position within which a probe has returned, nm for each us since:
/// the journal moves by less than .5 m/s.
const RETURNED_NM_US: u32 = 500;
/// The same of the shaft's angle, nrad for each us.
const RETURNED_NRAD_US: u32 = 100_000;

/// Memory of the last jump.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Jumps {
    /// Samples for which the sensors are not trusted.
    suspect: u32,
    trusted_y_nm: i32,
    trusted_z_nm: i32,
    trusted_angle_nrad: i32,
    /// Time since that sample, us.
    age_us: u32,
    has_trusted: bool,
    was_missing: bool,
}
words!(Jumps { suspect, trusted_y_nm, trusted_z_nm, trusted_angle_nrad, age_us, has_trusted, was_missing });

impl Jumps {
    /// Takes a sample; returns true if its motion can be trusted. `is_missing`: a channel of the
    /// motion has no value. `passed_us` is the time since the last sample; `has_lost` is true if
    /// samples were lost between them.
    #[inline]
    pub(super) fn is_trusted(
        &mut self,
        frame: &SensorFrame,
        (has_jumped, is_missing): (bool, bool),
        (passed_us, has_lost): (u32, bool),
    ) -> bool {
        self.age_us = self.age_us.saturating_add(passed_us);
        // A missing value is no position: neither it nor the step from it is a jump.
        let is_jump = has_jumped & !is_missing & !self.was_missing;
        self.was_missing = is_missing;
        if is_jump {
            // After lost samples the last trusted one is further away.
            let may_continue = self.suspect > 0 || has_lost;
            let has_returned = may_continue && self.is_near(frame);
            self.suspect = if has_returned { 0 } else { SUSPECT_SAMPLES };
        }
        let is_trusted = (self.suspect == 0) & !is_missing;
        self.suspect = self.suspect.saturating_sub(1);
        if is_trusted {
            self.has_trusted = true;
            self.age_us = 0;
            self.trusted_y_nm = frame.journal_y_nm;
            self.trusted_z_nm = frame.journal_z_nm;
            self.trusted_angle_nrad = frame.shaft_angle_nrad;
        }
        is_trusted
    }

    /// Returns true if a sample is where the machine can have moved since the last trusted one.
    fn is_near(&self, frame: &SensorFrame) -> bool {
        let length = RETURNED_NM_US.saturating_mul(self.age_us);
        let angle = RETURNED_NRAD_US.saturating_mul(self.age_us);
        !self.has_trusted
            || (frame.journal_y_nm.abs_diff(self.trusted_y_nm) < length
                && frame.journal_z_nm.abs_diff(self.trusted_z_nm) < length
                && frame.shaft_angle_nrad.wrapping_sub(self.trusted_angle_nrad).unsigned_abs() < angle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: (bool, bool) = (false, false);
    const JUMPED: (bool, bool) = (true, false);
    const MISSING: (bool, bool) = (false, true);
    /// Time of the next sample at 10 kHz.
    const NEXT: (u32, bool) = (100, false);

    fn at(journal_y_nm: i32) -> SensorFrame {
        SensorFrame { journal_y_nm, ..SensorFrame::default() }
    }

    /// Memory with a trusted sample at 0.
    fn started() -> Jumps {
        let mut jumps = Jumps::default();
        assert!(jumps.is_trusted(&at(0), GOOD, NEXT));
        jumps
    }

    #[test]
    fn a_spike_is_over_when_the_probe_returns() {
        let mut jumps = started();
        assert!(!jumps.is_trusted(&at(80_000), JUMPED, NEXT));
        assert!(jumps.is_trusted(&at(1_000), JUMPED, NEXT) && jumps.is_trusted(&at(2_000), GOOD, NEXT));
    }

    #[test]
    fn a_spike_is_over_at_every_sample_period_when_the_journal_moves_on() {
        for period_us in [50, 100, 300, 1_000] {
            let (mut jumps, next) = (started(), (period_us, false));
            assert!(!jumps.is_trusted(&at(2_000_000), JUMPED, next));
            let moved_nm = 2 * period_us as i32 * 400;
            assert!(jumps.is_trusted(&at(moved_nm), JUMPED, next), "{period_us} us");
        }
    }

    #[test]
    fn a_second_wrong_angle_is_no_return() {
        let mut jumps = started();
        let turned = |shaft_angle_nrad| SensorFrame { shaft_angle_nrad, ..SensorFrame::default() };
        assert!(!jumps.is_trusted(&turned(50_000_000), JUMPED, NEXT));
        assert!(!jumps.is_trusted(&turned(-70_000_000), JUMPED, NEXT));
        assert!(jumps.is_trusted(&turned(100_000), JUMPED, NEXT));
    }

    #[test]
    fn after_lost_samples_a_step_is_trusted_as_far_as_the_machine_can_move() {
        assert!(started().is_trusted(&at(400_000), JUMPED, (1_000, true)));
        assert!(!started().is_trusted(&at(600_000), JUMPED, (1_000, true)));
        assert!(!started().is_trusted(&at(80_000), JUMPED, (100, true)));
    }

    #[test]
    fn a_missing_value_is_never_trusted_and_the_step_from_it_is_no_jump() {
        for missing in [at(i32::MIN), at(0)] {
            let mut jumps = started();
            assert!((0..200).all(|_| !jumps.is_trusted(&missing, MISSING, NEXT)));
            assert!(jumps.is_trusted(&at(300_000), JUMPED, NEXT));
        }
    }

    #[test]
    fn the_first_values_after_missing_ones_are_no_jump() {
        let mut jumps = Jumps::default();
        assert!(!jumps.is_trusted(&at(0), MISSING, NEXT));
        assert!(jumps.is_trusted(&at(500_000), JUMPED, NEXT));
    }

    #[test]
    fn a_position_that_stays_away_is_trusted_after_the_time_of_a_stuck_probe() {
        let mut jumps = started();
        let trusted = |index: &u32| jumps.is_trusted(&at(300_000), (*index == 0, false), NEXT);
        assert_eq!((0..1000).filter(trusted).count(), 1000 - SUSPECT_SAMPLES as usize);
    }

    #[test]
    fn a_probe_that_runs_away_in_jumps_stays_suspect() {
        let mut jumps = started();
        assert!((1..100).all(|index| !jumps.is_trusted(&at(300_000 * index), JUMPED, NEXT)));
    }
}
