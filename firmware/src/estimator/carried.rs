//! Sum of what one tick carries over to the next: whoever finds another one at the next tick goes on with something that nobody has computed.
//!
//! Each word is added to the sum turned by [`TURN`] bits, exclusive or: any one bit that flips, in a word or in the sum kept beside them, shows for
//! certain. An error there would look like a motion and fade over some samples, too small for any limit.

/// Odd, so that the bits of neighbouring words do not lie on each other.
const TURN: u32 = 7;

/// The sum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Carried(u32);

impl Carried {
    #[inline]
    pub(super) const fn word(&mut self, word: u32) {
        self.0 = self.0.rotate_left(TURN) ^ word;
    }

    /// The sum itself, or another one, so that what was carried over from a spoilt tick is not taken.
    #[inline]
    pub(super) fn spoilt(self, spoilt: bool) -> Self {
        Self(self.0 ^ u32::from(spoilt))
    }

    #[inline]
    pub(super) const fn wide(&mut self, word: i64) {
        let word = word.cast_unsigned();
        self.word(word as u32);
        self.word((word >> 32) as u32);
    }
}

#[cfg(test)]
mod tests {
    use super::Carried;
    use crate::estimator::{Estimator, flags_of};
    use inference::{Bearing, Flags, shipped};
    use link::{Configuration, EstimateFrame, SensorFrame};

    #[test]
    fn the_sum_of_a_spoilt_tick_is_not_found_again() {
        let mut sum = Carried::default();
        sum.wide(-7);
        assert_ne!(sum.spoilt(true), sum);
        assert_eq!(sum.spoilt(false), sum);
    }

    /// A journal in lasting contact that swings by 2 um at 5 Hz along z: slowly enough for observer and window to agree.
    fn frame(index: u32) -> SensorFrame {
        let swing = (f64::from(index) * 0.0005 * core::f64::consts::TAU).sin();
        SensorFrame {
            sequence: index,
            time_us: 100 * index,
            journal_y_nm: 3_000,
            journal_z_nm: -530_000 - (2_000.0 * swing) as i32,
            shaft_angle_nrad: 30_000 * index.cast_signed(),
            load_force_mn: 0,
        }
    }

    fn estimator() -> Estimator {
        let configuration = Configuration {
            bearing: Bearing::Babbitt.code(),
            radial_clearance_nm: 500_000,
            journal_radius_nm: 69_500_000,
            sample_period_us: 100,
            latch_floor_um_s: 1_000,
            unseen_approach_um_s: 3_000,
        };
        Estimator::new(shipped(Bearing::Babbitt), configuration).unwrap()
    }

    fn run(altered_at: u32) -> Vec<EstimateFrame> {
        let mut estimator = estimator();
        let step = |index| {
            estimator.carried.0 ^= u32::from(index == altered_at);
            estimator.step(&frame(index))
        };
        (0..1_500).map(step).collect()
    }

    #[test]
    fn a_gap_in_the_samples_alters_nothing() {
        let gap = |index: u32| frame(if index < 1_000 { index } else { index + 5 });
        let mut estimator = estimator();
        let told = (0..1_200).any(|index| flags_of(&estimator.step(&gap(index))).contains(Flags::ALTERED));
        assert!(!told);
    }

    #[test]
    fn what_was_altered_between_two_ticks_is_flagged_once_and_begun_anew() {
        let (sound, altered) = (run(u32::MAX), run(1_000));
        let flagged = |estimates: &[EstimateFrame]| -> Vec<u32> {
            let marked = estimates.iter().filter(|estimate| flags_of(estimate).contains(Flags::ALTERED));
            marked.map(|estimate| estimate.sequence).collect()
        };
        assert_eq!(flagged(&sound), []);
        assert_eq!(flagged(&altered), [1_000]);
        assert_eq!(sound[..1_000], altered[..1_000]);
        // The window is in charge at once: off by what the observer makes of the swing, and by nothing once that is back.
        let off = |from: usize| {
            let pairs = sound.iter().zip(&altered).skip(from);
            pairs.fold(0.0, |most, (a, b)| f32::max(most, (a.normal_force_n - b.normal_force_n).abs()))
        };
        let full_scale = sound.iter().fold(0.0, |most, estimate| f32::max(most, estimate.normal_force_n));
        assert!(off(1_000) < 0.05 * full_scale, "{} of {full_scale} N", off(1_000));
        assert!(off(1_450) < 0.002 * full_scale, "{} of {full_scale} N", off(1_450));
    }
}
