//! Positions after a jump: a probe that has jumped is not trusted until it has returned, or until a
//! stuck one would have been found.

use crate::integrity::words;
use link::SensorFrame;

/// Samples for which a position is not trusted after a jump: longer than the default time after
/// which an unchanged code counts as stuck.
const SUSPECT_SAMPLES: u32 = 128;
/// Distance from the last trusted position within which a probe has returned, nm.
const RETURNED_NM: u32 = 50_000;

/// Memory of the last jump.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Jumps {
    /// Samples for which the position is not trusted.
    suspect: u32,
    trusted_y_nm: i32,
    trusted_z_nm: i32,
    was_missing: bool,
}
words!(Jumps { suspect, trusted_y_nm, trusted_z_nm, was_missing });

impl Jumps {
    /// Takes a sample; returns true if its position can be trusted.
    #[inline]
    pub(super) fn is_trusted(&mut self, frame: &SensorFrame, has_jumped: bool) -> bool {
        let (y, z) = (frame.journal_y_nm, frame.journal_z_nm);
        // A missing value is no position: neither it nor the step from it is a jump.
        let is_missing = (y == i32::MIN) | (z == i32::MIN);
        let is_jump = has_jumped & !is_missing & !self.was_missing;
        self.was_missing = is_missing;
        if is_jump {
            let has_returned = self.suspect > 0
                && y.abs_diff(self.trusted_y_nm) < RETURNED_NM
                && z.abs_diff(self.trusted_z_nm) < RETURNED_NM;
            self.suspect = if has_returned { 0 } else { SUSPECT_SAMPLES };
        }
        let is_trusted = (self.suspect == 0) & !is_missing;
        self.suspect = self.suspect.saturating_sub(1);
        if is_trusted {
            (self.trusted_y_nm, self.trusted_z_nm) = (y, z);
        }
        is_trusted
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(journal_y_nm: i32) -> SensorFrame {
        SensorFrame { journal_y_nm, ..SensorFrame::default() }
    }

    #[test]
    fn a_spike_is_over_when_the_probe_returns() {
        let mut jumps = Jumps::default();
        assert!(jumps.is_trusted(&at(0), false));
        assert!(!jumps.is_trusted(&at(80_000), true));
        assert!(jumps.is_trusted(&at(1_000), true) && jumps.is_trusted(&at(2_000), false));
    }

    #[test]
    fn a_position_that_stays_away_is_trusted_after_the_time_of_a_stuck_probe() {
        let mut jumps = Jumps::default();
        assert!(jumps.is_trusted(&at(0), false));
        let trusted = |index: &u32| jumps.is_trusted(&at(300_000), *index == 0);
        assert_eq!((0..1000).filter(trusted).count(), 1000 - SUSPECT_SAMPLES as usize);
    }

    #[test]
    fn jumps_to_and_fro_keep_the_position_suspect() {
        let mut jumps = Jumps::default();
        assert!((1..100).all(|index| !jumps.is_trusted(&at(300_000 * index), true)));
    }
}
