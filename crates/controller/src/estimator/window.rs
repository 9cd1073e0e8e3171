//! Value and slope of a sampled quantity: a parabola fitted by least squares to the last `N`
//! samples, read at the newest.
//!
//! A straight line would delay the slope by half its window, while the journal swings in its
//! clearance at 30 to 65 Hz. The parabola has no delay for a constant acceleration, but more noise
//! (the table is in [`super::signals`]).
//!
//! The fit is linear in three sums over the age `k` of a sample: `sum x`, `sum k x`, `sum k^2 x`.
//! They are updated recursively by additions, so a sample costs the same for every `N`. They are
//! exact integers: nothing drifts, and a sample that has left the window has no effect. They may
//! wrap; only the result has to fit. The weights follow from the discrete orthogonal polynomials
//! `p1 = 2k - (N-1)` and `p2 = 6k^2 - 6(N-1)k + (N-1)(N-2)`.
//!
//! [`Window`] holds magnitudes below 2^31 over the sum of the ages (7.7e6 for 24 samples, 3.4e6 for
//! 36), [`WideWindow`] magnitudes below 2^36.

/// Sums over the last `N` samples of one quantity. Missing samples at the start count as 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Window<const N: usize> {
    sum: i32,
    first: i32,
    second: i64,
}

/// The same sums for 64-bit samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WideWindow<const N: usize> {
    sum: i64,
    first: i64,
    second: i64,
}

/// Weights of the three sums; the weight of the second sum comes first.
const fn slope_weights(n: i64) -> [i64; 3] {
    [30 * (n - 1), -30 * (n - 1) * (n - 1) - 2 * (n * n - 4), (n - 1) * (5 * (n - 1) * (n - 2) + n * n - 4)]
}

const fn value_weights(n: i64) -> [i64; 3] {
    [30, -18 * (2 * n - 1), 3 * (3 * n * n - 3 * n + 2)]
}

const fn slope_denominator(n: i64) -> i64 {
    n * (n * n - 1) * (n * n - 4) / 6
}

impl<const N: usize> Window<N> {
    const LENGTH: i64 = N as i64;
    /// Divisor of [`Self::slope`] that gives the slope per sample.
    pub const SLOPE_DENOMINATOR: i64 = slope_denominator(Self::LENGTH);
    /// Divisor of [`Self::value`].
    pub const VALUE_DENOMINATOR: i64 = Self::LENGTH * (Self::LENGTH + 1) * (Self::LENGTH + 2);

    /// Takes the newest sample and drops the sample that is `N` samples older.
    #[inline]
    pub fn push(&mut self, newest: i32, oldest: i32) {
        self.second = self
            .second
            .wrapping_add(i64::from(self.first) << 1)
            .wrapping_add(i64::from(self.sum))
            .wrapping_add(i64::from(oldest).wrapping_mul(-Self::LENGTH * Self::LENGTH));
        self.first = self.first.wrapping_add(self.sum).wrapping_sub(oldest.wrapping_mul(N as i32));
        self.sum = self.sum.wrapping_add(newest).wrapping_sub(oldest);
    }

    /// Returns the slope at the newest sample, times [`Self::SLOPE_DENOMINATOR`].
    #[inline]
    #[must_use]
    pub fn slope(&self) -> i64 {
        self.weighted(slope_weights(Self::LENGTH))
    }

    /// Returns the value at the newest sample less that sample, times [`Self::VALUE_DENOMINATOR`].
    #[inline]
    #[must_use]
    pub fn value(&self, newest: i32) -> i64 {
        self.weighted(value_weights(Self::LENGTH))
            .wrapping_add(i64::from(newest).wrapping_mul(-Self::VALUE_DENOMINATOR))
    }

    #[inline]
    fn weighted(&self, [second, first, sum]: [i64; 3]) -> i64 {
        self.second
            .wrapping_mul(second)
            .wrapping_add(i64::from(self.first).wrapping_mul(first))
            .wrapping_add(i64::from(self.sum).wrapping_mul(sum))
    }
}

impl<const N: usize> WideWindow<N> {
    const LENGTH: i64 = N as i64;
    /// Divisor of [`Self::slope`] that gives the slope per sample.
    pub const SLOPE_DENOMINATOR: i64 = slope_denominator(Self::LENGTH);

    /// Takes the newest sample and drops the sample that is `N` samples older.
    #[inline]
    pub const fn push(&mut self, newest: i64, oldest: i64) {
        self.second = self
            .second
            .wrapping_add(self.first << 1)
            .wrapping_add(self.sum)
            .wrapping_sub(oldest.wrapping_mul(Self::LENGTH * Self::LENGTH));
        self.first = self.first.wrapping_add(self.sum).wrapping_sub(oldest.wrapping_mul(Self::LENGTH));
        self.sum = self.sum.wrapping_add(newest).wrapping_sub(oldest);
    }

    /// Returns the slope at the newest sample, times [`Self::SLOPE_DENOMINATOR`].
    #[inline]
    #[must_use]
    pub const fn slope(&self) -> i64 {
        let [second, first, sum] = slope_weights(Self::LENGTH);
        self.second
            .wrapping_mul(second)
            .wrapping_add(self.first.wrapping_mul(first))
            .wrapping_add(self.sum.wrapping_mul(sum))
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Fits a window to samples, the oldest first: value and slope. Asserts that the wide window
    /// agrees.
    pub(in crate::estimator) fn fits<const N: usize>(samples: &[i32]) -> Vec<(f64, f64)> {
        let (mut window, mut wide) = (Window::<N>::default(), WideWindow::<N>::default());
        (samples.iter().enumerate())
            .map(|(index, &newest)| {
                let oldest = index.checked_sub(N).and_then(|i| samples.get(i)).copied().unwrap_or(0);
                window.push(newest, oldest);
                wide.push(newest.into(), oldest.into());
                assert_eq!(window.slope(), wide.slope());
                let value = window.value(newest) as f64 / Window::<N>::VALUE_DENOMINATOR as f64;
                let slope = window.slope() as f64 / Window::<N>::SLOPE_DENOMINATOR as f64;
                (f64::from(newest) + value, slope)
            })
            .collect()
    }

    /// Weights of value and slope by age: the response to a single sample of 1.
    pub(in crate::estimator) fn weights<const N: usize>() -> (Vec<f64>, Vec<f64>) {
        let samples: Vec<i32> = (0..2 * N).map(|i| i32::from(i == N)).collect();
        fits::<N>(&samples).into_iter().skip(N).take(N).unzip()
    }

    /// The fit by least squares in floating point.
    fn oracle<const N: usize>(samples: &[i32]) -> (f64, f64) {
        let n = N as f64;
        let (mut value, mut slope) = (0.0, 0.0);
        for (age, &sample) in samples.iter().rev().take(N).enumerate() {
            let (k, sample) = (age as f64, f64::from(sample));
            let p1 = 2.0 * k - (n - 1.0);
            let p2 = 6.0 * k * k - 6.0 * (n - 1.0) * k + (n - 1.0) * (n - 2.0);
            value += sample * 3.0 * (3.0 * n * n - 3.0 * n + 2.0 - 6.0 * (2.0 * n - 1.0) * k + 10.0 * k * k);
            slope += sample * (5.0 * (n - 1.0) * p2 - (n * n - 4.0) * p1);
        }
        (value / (n * (n + 1.0) * (n + 2.0)), slope / (n * (n * n - 1.0) * (n * n - 4.0) / 6.0))
    }

    fn exact_on_parabolas<const N: usize>(offset: i32, speed: i32, half_acceleration: i32) {
        let parabola = |t: i32| offset + speed * t + half_acceleration * t * t;
        // Large values before the parabola must leave no trace.
        let wild = (0..5).map(|i| 3_000_000 * (i % 2));
        let samples: Vec<i32> = wild.chain((1 - N as i32..=0).map(parabola)).collect();
        assert_eq!(fits::<N>(&samples).last(), Some(&(f64::from(offset), f64::from(speed))));
    }

    proptest! {
        #[test]
        fn a_parabola_is_fitted_exactly(
            offset in -900_000..900_000_i32, speed in -2000..2000_i32, half in -20..20_i32,
        ) {
            exact_on_parabolas::<24>(offset, speed, half);
            exact_on_parabolas::<36>(offset, speed, half);
        }

        #[test]
        fn any_samples_are_fitted_as_in_floating_point(
            samples in prop::collection::vec(-3_400_000..3_400_000_i32, 36..150),
        ) {
            for (found, expected) in [
                (fits::<36>(&samples).pop().unwrap(), oracle::<36>(&samples)),
                (fits::<24>(&samples).pop().unwrap(), oracle::<24>(&samples)),
            ] {
                let errors = [found.0 - expected.0, found.1 - expected.1];
                prop_assert!(errors.iter().all(|error| error.abs() < 1e-4), "{:?} {:?}", found, expected);
            }
        }

        #[test]
        fn a_wide_window_is_shifted_by_any_offset(
            samples in prop::collection::vec(any::<i32>(), 64..130), offset in any::<i64>(),
        ) {
            let slope = |offset: i64| {
                let mut window = WideWindow::<64>::default();
                for (index, &newest) in samples.iter().enumerate() {
                    let leaving = index.checked_sub(64);
                    let oldest = leaving.map_or(0, |i| i64::from(samples[i]).wrapping_add(offset));
                    window.push(i64::from(newest).wrapping_add(offset), oldest);
                }
                window.slope()
            };
            prop_assert_eq!(slope(0), slope(offset));
        }
    }

    #[test]
    fn no_fit_of_a_window_in_use_overflows() {
        fn largest<const N: usize>() -> f64 {
            let (value, slope) = weights::<N>();
            let sum = |w: &[f64], den: i64| w.iter().map(|w| w.abs()).sum::<f64>() * den as f64;
            sum(&value, Window::<N>::VALUE_DENOMINATOR).max(sum(&slope, Window::<N>::SLOPE_DENOMINATOR))
        }
        // Below 2^26: samples of 2^36 leave the sum below 2^62.
        for largest in [largest::<24>(), largest::<36>(), largest::<64>()] {
            assert!(largest < f64::from(1 << 26), "{largest}");
        }
    }
}
