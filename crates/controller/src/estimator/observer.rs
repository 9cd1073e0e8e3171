//! Deformation and its rate: predicted by Newton's law, corrected by the measured position, taken
//! from the window where the prediction fails.
//!
//! The observer carries deformation and rate forward by the rate that [`super::newton`] predicts
//! and a slow remainder. It corrects both by the innovation, the difference between measured and
//! predicted position. Its gains are those of a Kalman filter for 0.2 um of noise and a remainder
//! that wanders by 10 nm/s a sample ([`POSITION_GAIN`], [`RATE_GAIN`]). Without a prediction the
//! observer is late; with one, only the error of the prediction is late.
//!
//! The innovation also shows whether the prediction holds: averaged over 8 samples it is at most a
//! quarter of the sensor's noise. Its mean square (over 32 samples while it grows, 64 while it
//! falls) decides: below a quarter of the noise's the observer counts alone, above half of the
//! noise's the parabola of [`super::signals`] counts alone, in between both are mixed. The parabola
//! also counts alone without contact, before its window is full, without masses, and when the
//! observer has lost the journal by 32 um. At an onset the observer starts from the parabola; its
//! mean square then starts at [`START_NOISE`] times the noise's and takes 18 ms to fall.
//!
//! Integers: positions in nm/16 outside and nm/2^24 inside, rates in nm/s outside and nm/s over
//! 2^16 inside. No branch depends on data.

use super::arithmetic::{Factor, product, saturated, select, select_wide, within};
use super::conditioning::NOISE_RANGE_NM;
use super::geometry::DISTANCE_STEPS_PER_NM;
use crate::integrity::words;

/// Share of the innovation that corrects the position, over 2^20.
pub(super) const POSITION_GAIN: i32 = 99_775;
/// Share of the innovation that corrects the rate per sample, over 2^20.
pub(super) const RATE_GAIN: u32 = 4_987;
/// Fraction bits of a position inside the observer.
const INSIDE_BITS: u32 = 24;
/// Fraction bits of a position outside.
const OUTSIDE_BITS: u32 = DISTANCE_STEPS_PER_NM.ilog2();
/// Logarithm to base 2 of the samples over which the innovation is averaged.
const MEAN_SHIFT: u32 = 3;
/// Logarithm to base 2 of the samples over which its square is averaged while it grows.
const ATTACK_SHIFT: u32 = 5;
/// The same while it falls.
const RELEASE_SHIFT: u32 = 6;
/// Fraction bits of the mean innovation.
const MEAN_BITS: u32 = 8;
/// Logarithm to base 2 of the innovation, 32.8 um, at which the observer has lost the journal and
/// restarts from the window.
const INNOVATION_BITS: u32 = 15 + OUTSIDE_BITS;
/// Mean square at a restart, as a multiple of the noise's.
const START_NOISE: i32 = 4;
/// Fraction bits of the window's share.
const SHARE_BITS: u32 = 15;
/// Fraction bits of a rate inside.
const RATE_BITS: u32 = 16;
/// Fraction bits of a step per sample.
const STEP_BITS: u32 = 12;

/// Observer of deformation and rate.
#[derive(Clone, Debug)]
pub(super) struct Observer {
    noise_square: i32,
    per_range: Factor,
    is_always_window: bool,
    per_sample: Factor,
    rate_gain: i32,
}
words!(Observer { noise_square, per_range, is_always_window, per_sample, rate_gain });

/// State of an [`Observer`].
#[derive(Clone, Copy, Debug)]
pub(super) struct ObserverState {
    /// Deformation, nm/2^24.
    position: i64,
    /// Part of the rate that is not predicted, nm/s over 2^16.
    remainder: i64,
    /// Mean innovation, nm/2^8.
    mean: i32,
    /// Mean square of the mean innovation, nm2.
    mean_square: i32,
}
words!(ObserverState { position, remainder, mean, mean_square });

/// Deformation in nm/16 and its rate in nm/s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Radial {
    pub(super) deformation: i32,
    pub(super) rate_nm_s: i32,
}
words!(Radial { deformation, rate_nm_s });

impl Observer {
    /// Creates an observer for a sample period and a standard deviation of the position's noise.
    /// Without predictions the window always counts alone.
    pub(super) fn new(period_us: u32, noise_nm: u32, has_predictions: bool) -> Self {
        let noise_nm = noise_nm.max(*NOISE_RANGE_NM.start()).min(*NOISE_RANGE_NM.end());
        let noise_square = noise_nm.wrapping_mul(noise_nm).cast_signed();
        let range = noise_square >> 2;
        Self {
            noise_square,
            per_range: Factor::new(1 << SHARE_BITS, u64::from(range.cast_unsigned())),
            is_always_window: !has_predictions,
            per_sample: Factor::new(u64::from(period_us) << STEP_BITS, 1_000_000),
            // A step outside, nm/16, per sample in nm/s over 2^16: at most 2^23 for 50 us and more.
            rate_gain: (u64::from(RATE_GAIN).wrapping_mul(1_000_000 << (RATE_BITS - OUTSIDE_BITS))
                / (u64::from(period_us.max(1)) << 20)) as i32,
        }
    }

    /// The state before the first sample.
    pub(super) const fn start(&self) -> ObserverState {
        let mean_square = self.noise_square.wrapping_mul(START_NOISE);
        ObserverState { position: 0, remainder: 0, mean: 0, mean_square }
    }

    /// Takes a measured deformation, the window's result and the predicted rate. `is_open` is true
    /// without contact or full window.
    #[inline]
    pub(super) fn step(
        &self,
        state: &mut ObserverState,
        measured: i32,
        window: Radial,
        predicted_nm_s: i32,
        is_open: bool,
    ) -> Radial {
        let inside = |nm: i32| i64::from(nm) << (INSIDE_BITS - OUTSIDE_BITS);
        let remainder = saturated(state.remainder >> RATE_BITS);
        let step = self.per_sample.times(remainder.saturating_add(predicted_nm_s));
        let position = state.position.wrapping_add(i64::from(step) << (INSIDE_BITS - STEP_BITS));
        let innovation = saturated(inside(measured).wrapping_sub(position) >> (INSIDE_BITS - OUTSIDE_BITS));
        let limited = within(innovation, INNOVATION_BITS);
        let is_open = is_open | (limited != innovation);
        let innovation = limited;
        // A step outside over 2^20 is 2^20 steps inside over 2^20.
        let position = position.wrapping_add(product(innovation, POSITION_GAIN, 0));
        let remainder = state.remainder.wrapping_add(product(innovation, self.rate_gain, 0));

        let mean = state
            .mean
            .wrapping_add((innovation << (MEAN_BITS - OUTSIDE_BITS)).wrapping_sub(state.mean) >> MEAN_SHIFT);
        let square = product(mean, mean, 2 * MEAN_BITS) as i32;
        let change = square.wrapping_sub(state.mean_square);
        let change = select(change > 0, change >> ATTACK_SHIFT, change >> RELEASE_SHIFT);
        let mean_square = state.mean_square.wrapping_add(change);

        state.position = select_wide(is_open, inside(window.deformation), position);
        state.remainder = select_wide(is_open, i64::from(window.rate_nm_s) << RATE_BITS, remainder);
        state.mean = select(is_open, 0, mean);
        state.mean_square = select(is_open, self.noise_square.wrapping_mul(START_NOISE), mean_square);

        let excess = state.mean_square.wrapping_sub(self.noise_square >> 2);
        #[expect(clippy::manual_clamp, reason = "a clamp may panic")]
        let share = self.per_range.times(excess).max(0).min(1 << SHARE_BITS);
        let share = select(is_open | self.is_always_window, 1 << SHARE_BITS, share);
        let deformation = saturated(state.position >> (INSIDE_BITS - OUTSIDE_BITS));
        let rate_nm_s =
            saturated(state.remainder >> RATE_BITS).saturating_add(select(is_open, 0, predicted_nm_s));
        let mixed = |observed: i32, fitted: i32| {
            observed.saturating_add(product(fitted.saturating_sub(observed), share, SHARE_BITS) as i32)
        };
        Radial {
            deformation: mixed(deformation, window.deformation),
            rate_nm_s: mixed(rate_nm_s, window.rate_nm_s),
        }
    }
}
