//! What a sensor sample may look like: every doubt becomes a flag, never a guess.
//!
//! The limits are those of the machine, not of the networks: 0.5 m/s is three times what the journal reaches falling freely through the widest
//! clearance, 100 rad/s fifty times the rudder shaft's speed. The allowances on top are far above sensor noise (0.2 um, 20 urad).

use inference::Flags;
use link::SensorFrame;

use crate::flags::{IMPLAUSIBLE_POSITION, JUMP, SEQUENCE_GAP, STUCK, TIME_FAULT};

/// Deformation above which the position cannot be true, nm.
pub const MAX_DEFORMATION_NM: u32 = 500_000;
/// Samples of one unchanging code after which a sensor counts as stuck: 10 ms at 10 kHz.
pub const STUCK_SAMPLES: u8 = 100;
/// Journal speed that the machine cannot exceed, nm/us (mm/s): 0.5 m/s.
const MAX_JOURNAL_SPEED_NM_US: u32 = 500;
/// Allowance on a journal step for noise, nm.
const JOURNAL_ALLOWANCE_NM: u32 = 5_000;
/// Shaft speed that the machine cannot exceed, nrad/us: 100 rad/s.
const MAX_SHAFT_SPEED_NRAD_US: u32 = 100_000;
/// Allowance on an angle step for noise, nrad.
const ANGLE_ALLOWANCE_NRAD: u32 = 500_000;

/// Watches the samples of one run.
#[derive(Clone, Debug)]
pub struct Plausibility {
    period_us: u32,
    farthest_nm: u32,
    previous: Option<SensorFrame>,
    unchanged: [u8; 3],
}

/// Doubts after which the samples before this one no longer belong to it.
pub(super) const DISCONTINUITY: Flags =
    Flags::from_bits(JUMP.bits() | SEQUENCE_GAP.bits() | TIME_FAULT.bits());

impl Plausibility {
    /// Creates a watch for a bearing and a sample period.
    #[must_use]
    pub const fn new(radial_clearance_nm: u32, period_us: u32) -> Self {
        let farthest_nm = radial_clearance_nm.saturating_add(MAX_DEFORMATION_NM);
        Self { period_us, farthest_nm, previous: None, unchanged: [0; 3] }
    }

    /// Takes a sample and returns the doubts about it.
    pub fn check(&mut self, frame: &SensorFrame) -> Flags {
        let mut flags = IMPLAUSIBLE_POSITION.when(self.is_too_far(frame));
        if let Some(previous) = self.previous.replace(*frame) {
            let elapsed_us = frame.time_us.wrapping_sub(previous.time_us);
            flags |= SEQUENCE_GAP.when(frame.sequence != previous.sequence.wrapping_add(1));
            flags |= TIME_FAULT.when(elapsed_us.abs_diff(self.period_us) > self.period_us / 2);
            let steps = [
                frame.journal_y_nm.wrapping_sub(previous.journal_y_nm),
                frame.journal_z_nm.wrapping_sub(previous.journal_z_nm),
                frame.shaft_angle_nrad.wrapping_sub(previous.shaft_angle_nrad),
            ];
            let journal_nm =
                self.period_us.saturating_mul(MAX_JOURNAL_SPEED_NM_US).saturating_add(JOURNAL_ALLOWANCE_NM);
            let angle_nrad =
                self.period_us.saturating_mul(MAX_SHAFT_SPEED_NRAD_US).saturating_add(ANGLE_ALLOWANCE_NRAD);
            let limits = [journal_nm, journal_nm, angle_nrad];
            for ((step, limit), unchanged) in steps.iter().zip(limits).zip(&mut self.unchanged) {
                flags |= JUMP.when(step.unsigned_abs() > limit);
                *unchanged = if *step == 0 { unchanged.saturating_add(1) } else { 0 };
                flags |= STUCK.when(*unchanged >= STUCK_SAMPLES - 1);
            }
        }
        flags
    }

    fn is_too_far(&self, frame: &SensorFrame) -> bool {
        let square =
            |value: i32| u64::from(value.unsigned_abs()).saturating_mul(u64::from(value.unsigned_abs()));
        let distance = square(frame.journal_y_nm).saturating_add(square(frame.journal_z_nm));
        distance > u64::from(self.farthest_nm).saturating_mul(u64::from(self.farthest_nm))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CLEARANCE_NM: u32 = 500_000;

    /// A lively but possible sample.
    fn frame(sequence: u32) -> SensorFrame {
        let wobble = i32::try_from(sequence % 7).unwrap() * 300;
        SensorFrame {
            sequence,
            time_us: sequence.wrapping_mul(100),
            journal_y_nm: 100_000 + wobble,
            journal_z_nm: -490_000 - wobble,
            shaft_angle_nrad: 5_000 * wobble,
            load_force_mn: 0,
        }
    }

    fn after_ten() -> Plausibility {
        let mut watch = Plausibility::new(CLEARANCE_NM, 100);
        for sequence in 0..10 {
            assert_eq!(watch.check(&frame(sequence)), Flags::NONE);
        }
        watch
    }

    #[test]
    fn sequence_and_time_may_wrap() {
        let mut watch = Plausibility::new(CLEARANCE_NM, 100);
        for sequence in (u32::MAX - 5..=u32::MAX).chain(0..5) {
            assert_eq!(watch.check(&frame(sequence)), Flags::NONE, "{sequence}");
        }
    }

    #[test]
    fn lost_and_repeated_samples_are_noticed() {
        assert!(after_ten().check(&frame(11)).contains(SEQUENCE_GAP | TIME_FAULT));
        assert!(after_ten().check(&frame(9)).contains(SEQUENCE_GAP | TIME_FAULT));
    }

    #[test]
    fn time_must_advance_by_the_period() {
        for (time_us, fault) in
            [(1000, false), (1049, false), (951, false), (1051, true), (900, true), (899, true)]
        {
            let flags = after_ten().check(&SensorFrame { time_us, ..frame(10) });
            assert_eq!(flags, TIME_FAULT.when(fault), "{time_us}");
        }
    }

    #[test]
    fn impossible_steps_are_noticed() {
        let next = frame(10);
        for jumped in [
            SensorFrame { journal_y_nm: next.journal_y_nm + 60_000, ..next },
            SensorFrame { journal_z_nm: next.journal_z_nm + 60_000, ..next },
            SensorFrame { shaft_angle_nrad: next.shaft_angle_nrad - 20_000_000, ..next },
        ] {
            assert_eq!(after_ten().check(&jumped), JUMP);
        }
    }

    #[test]
    fn a_journal_outside_the_bearing_is_noticed() {
        let mut watch = Plausibility::new(CLEARANCE_NM, 100);
        let at = |y, z| SensorFrame { journal_y_nm: y, journal_z_nm: z, ..SensorFrame::default() };
        assert_eq!(watch.check(&at(600_000, -799_000)), Flags::NONE);
        let mut watch = Plausibility::new(CLEARANCE_NM, 100);
        assert_eq!(watch.check(&at(600_000, -801_000)), IMPLAUSIBLE_POSITION);
        assert!(watch.check(&at(i32::MIN, i32::MIN)).contains(IMPLAUSIBLE_POSITION | JUMP));
    }

    #[test]
    fn one_stuck_sensor_is_noticed_while_the_others_move() {
        let mut watch = Plausibility::new(CLEARANCE_NM, 100);
        for sequence in 0..200 {
            let stuck = SensorFrame { journal_z_nm: -490_123, ..frame(sequence) };
            assert_eq!(
                watch.check(&stuck),
                STUCK.when(sequence >= u32::from(STUCK_SAMPLES) - 1),
                "{sequence}"
            );
        }
        assert_eq!(watch.check(&frame(200)), Flags::NONE);
    }
}
