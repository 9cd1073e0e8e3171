//! Deformation and its rate: Newton's law ahead, the measured position behind, and the window where Newton's law does not hold.
//!
//! The observer carries deformation and rate forward by the rate that [`super::newton`] predicts and a slow rest, and
//! corrects both by what the measured position is off (the gains are those of a Kalman filter for 0.2 um of noise and a rest that
//! wanders by 10 nm/s a sample, [`POSITION_GAIN`] and [`RATE_GAIN`]). Alone, as for a motion that Newton's law knows nothing of, it would be late; with
//! the prediction only the prediction's error is.
//!
//! Whether the prediction holds shows in that same difference: averaged over 8 samples it is a quarter of the sensor's noise, no more. Its
//! mean square (over 32 samples while it grows, 64 while it falls) below a quarter of the noise's leaves the observer alone, above half of the
//! noise's hands over to the parabola of [`super::signals`], in between both are mixed. In a gap, before its window is full, without masses, and when it has lost the journal by 32 um it is the parabola that
//! counts, and the observer starts from it at an onset; its mean square then starts at [`DOUBT`] times the noise's and takes 18 ms to fall.
//!
//! What it carries over is in [`WordSum`]: a bit that flips there is found before the next step, which then begins anew from the window.
//!
//! Whole numbers: positions in nm/16 outside and nm/2^24 inside, rates in nm/s outside and nm/s over 2^16 inside. No branch on data.

use core::hash::Hash;

use super::geometry::DISTANCE_STEPS_PER_NM;
use super::whole::{Factor, product, saturated, select, select_wide, within};
use crate::constants::Sum;
use inference::held::WordSum;

/// Share of a difference that the position takes over, over 2^20.
pub(super) const POSITION_GAIN: i32 = 99_775;
/// Share that the rate takes over a sample, over 2^20.
pub(super) const RATE_GAIN: u32 = 4_987;
/// Fraction bits of a position inside, and of a position outside.
const INSIDE_BITS: u32 = 24;
const OUTSIDE_BITS: u32 = DISTANCE_STEPS_PER_NM.ilog2();
/// The difference is averaged over two to this power samples.
const MEAN_SHIFT: u32 = 3;
/// Its square over two to this power samples while it grows, and while it falls.
const ATTACK_SHIFT: u32 = 5;
const RELEASE_SHIFT: u32 = 6;
/// Fraction bits of the mean difference.
const MEAN_BITS: u32 = 8;
/// At a difference of 32.8 um the observer has lost the journal and starts from the window again.
const DIFFERENCE_BITS: u32 = 15 + OUTSIDE_BITS;
/// The mean square starts at so many times the noise's.
const DOUBT: i32 = 4;
/// Noise that can be served, nm: its square times [`DOUBT`] stays within 32 bits.
const NOISE_RANGE_NM: (u32, u32) = (10, 8_000);
/// Fraction bits of the parabola's share.
const SHARE_BITS: u32 = 15;
/// Fraction bits of a rate inside.
const RATE_BITS: u32 = 16;
/// Fraction bits of a step per sample.
const STEP_BITS: u32 = 12;

/// Position and rate, followed.
#[derive(Clone, Debug)]
pub(super) struct Observer {
    position: i64,
    rest: i64,
    mean: i32,
    mean_square: i32,
    noise_square: i32,
    per_range: Factor,
    always_window: bool,
    per_sample: Factor,
    rate_gain: i32,
}

/// Deformation in nm/16 and its rate in nm/s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Radial {
    pub(super) deformation: i32,
    pub(super) rate_nm_s: i32,
}

impl Observer {
    pub(super) fn constants(&self, sum: &mut Sum) {
        (self.noise_square, self.per_range, self.always_window, self.per_sample, self.rate_gain).hash(sum);
    }

    /// An observer for a sample period and a standard deviation of the position's noise. Without predictions it is the window that counts, always.
    pub(super) fn new(period_us: u32, noise_nm: u32, with_predictions: bool) -> Self {
        let noise_nm = noise_nm.max(NOISE_RANGE_NM.0).min(NOISE_RANGE_NM.1);
        let noise_square = noise_nm.wrapping_mul(noise_nm).cast_signed();
        let range = noise_square >> 2;
        Self {
            position: 0,
            rest: 0,
            mean: 0,
            mean_square: noise_square.wrapping_mul(DOUBT),
            noise_square,
            per_range: Factor::of(1 << SHARE_BITS, u64::from(range.cast_unsigned())),
            always_window: !with_predictions,
            per_sample: Factor::of(u64::from(period_us) << STEP_BITS, 1_000_000),
            // A step outside, a sixteenth of a nanometre, per sample in nm/s over 2^16: at most 2^23 for 50 us and more.
            rate_gain: (u64::from(RATE_GAIN).wrapping_mul(1_000_000 << (RATE_BITS - OUTSIDE_BITS))
                / (u64::from(period_us.max(1)) << 20)) as i32,
        }
    }

    /// What the next step goes on with.
    #[inline]
    pub(super) fn carried(&self, sum: &mut WordSum) {
        sum.wide(self.position);
        sum.wide(self.rest);
        sum.word(self.mean.cast_unsigned());
        sum.word(self.mean_square.cast_unsigned());
    }

    /// Takes a measured deformation, what the window makes of it, and the predicted rate. `open` says that there is no contact or no full window.
    #[inline(never)]
    pub(super) fn step(&mut self, measured: i32, window: Radial, predicted_nm_s: i32, open: bool) -> Radial {
        let inside = |nm: i32| i64::from(nm) << (INSIDE_BITS - OUTSIDE_BITS);
        let rest = saturated(self.rest >> RATE_BITS);
        let step = self.per_sample.times(rest.saturating_add(predicted_nm_s));
        let position = self.position.wrapping_add(i64::from(step) << (INSIDE_BITS - STEP_BITS));
        let off = saturated(inside(measured).wrapping_sub(position) >> (INSIDE_BITS - OUTSIDE_BITS));
        let near = within(off, DIFFERENCE_BITS);
        let open = open | (near != off);
        let off = near;
        // A step outside over 2^20, that is inside, is 2^20 steps inside over 2^20.
        let position = position.wrapping_add(product(off, POSITION_GAIN, 0));
        let rest = self.rest.wrapping_add(product(off, self.rate_gain, 0));

        let mean =
            self.mean.wrapping_add((off << (MEAN_BITS - OUTSIDE_BITS)).wrapping_sub(self.mean) >> MEAN_SHIFT);
        let square = product(mean, mean, 2 * MEAN_BITS) as i32;
        let change = square.wrapping_sub(self.mean_square);
        let change = select(change > 0, change >> ATTACK_SHIFT, change >> RELEASE_SHIFT);
        let mean_square = self.mean_square.wrapping_add(change);

        self.position = select_wide(open, inside(window.deformation), position);
        self.rest = select_wide(open, i64::from(window.rate_nm_s) << RATE_BITS, rest);
        self.mean = select(open, 0, mean);
        self.mean_square = select(open, self.noise_square.wrapping_mul(DOUBT), mean_square);

        let beyond = self.mean_square.wrapping_sub(self.noise_square >> 2);
        #[expect(clippy::manual_clamp, reason = "a clamp may panic")]
        let share = self.per_range.times(beyond).max(0).min(1 << SHARE_BITS);
        let share = select(open | self.always_window, 1 << SHARE_BITS, share);
        let deformation = saturated(self.position >> (INSIDE_BITS - OUTSIDE_BITS));
        let rate_nm_s = saturated(self.rest >> RATE_BITS).saturating_add(select(open, 0, predicted_nm_s));
        let mixed = |own: i32, other: i32| {
            own.saturating_add(product(other.saturating_sub(own), share, SHARE_BITS) as i32)
        };
        Radial {
            deformation: mixed(deformation, window.deformation),
            rate_nm_s: mixed(rate_nm_s, window.rate_nm_s),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Flips a bit of one number.
    type Flip = fn(&mut Observer, u32);

    #[test]
    fn every_bit_that_is_carried_over_counts() {
        let mut observer = Observer::new(100, 200, true);
        let quiet = Radial::default();
        for index in 0..50 {
            observer.step(1000 + index, quiet, 0, false);
        }
        let sum = |observer: &Observer| {
            let mut sum = WordSum::default();
            observer.carried(&mut sum);
            sum
        };
        let sound = sum(&observer);
        let flips: [(u32, Flip); 4] = [
            (64, |o, b| o.position ^= 1 << b),
            (64, |o, b| o.rest ^= 1 << b),
            (32, |o, b| o.mean ^= 1 << b),
            (32, |o, b| o.mean_square ^= 1 << b),
        ];
        for (bits, flip) in flips {
            for bit in 0..bits {
                let mut there = observer.clone();
                flip(&mut there, bit);
                assert_ne!(sum(&there), sound, "bit {bit}");
            }
        }
    }
}
