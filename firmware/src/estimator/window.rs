//! Value and slope of a sampled quantity: a parabola fitted by least squares to the last `N` samples, read at the newest.
//!
//! A straight line would delay the slope by half its window, while the journal swings in its clearance at 30 to 65 Hz; the parabola
//! has no delay for a constant acceleration and pays with noise (the table is in [`super::signals`]).
//!
//! The fit is linear in three sums over the age `k` of a sample, `sum x`, `sum k x`, `sum k^2 x`, and those follow from the ones before
//! by additions: a sample costs the same whatever `N` is. They are exact integers modulo 2^64, so nothing drifts, what has left
//! the window has left no trace, and only the fit itself has to stay below 2^63. The weights come from the discrete
//! orthogonal polynomials `p1 = 2k - (N-1)` and `p2 = 6k^2 - 6(N-1)k + (N-1)(N-2)`.

/// Sums over the last `N` samples of one quantity. Before `N` samples have come the others count as 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Window<const N: usize> {
    sum: i64,
    first: i64,
    second: i64,
}

impl<const N: usize> Window<N> {
    const LENGTH: i64 = N as i64;
    /// What [`Self::slope`] is to be divided by to be per sample.
    pub const SLOPE_DENOMINATOR: i64 =
        Self::LENGTH * (Self::LENGTH * Self::LENGTH - 1) * (Self::LENGTH * Self::LENGTH - 4) / 6;
    /// What [`Self::value`] is to be divided by.
    pub const VALUE_DENOMINATOR: i64 = Self::LENGTH * (Self::LENGTH + 1) * (Self::LENGTH + 2);

    /// Takes the newest sample and drops the one that came `N` samples before it.
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

    /// The slope at the newest sample, times [`Self::SLOPE_DENOMINATOR`].
    ///
    /// No overflow below a spread of 2^36 in the window: the weights' magnitudes sum up to 2^26 at most for the windows in use.
    #[inline]
    #[must_use]
    pub const fn slope(&self) -> i64 {
        let n = Self::LENGTH;
        self.weighted(
            30 * (n - 1),
            -30 * (n - 1) * (n - 1) - 2 * (n * n - 4),
            (n - 1) * (5 * (n - 1) * (n - 2) + n * n - 4),
        )
    }

    /// The value at the newest sample less that sample, times [`Self::VALUE_DENOMINATOR`]. No overflow, as for the slope.
    #[inline]
    #[must_use]
    pub const fn value(&self, newest: i64) -> i64 {
        let n = Self::LENGTH;
        self.weighted(30, -18 * (2 * n - 1), 3 * (3 * n * n - 3 * n + 2))
            .wrapping_sub(newest.wrapping_mul(Self::VALUE_DENOMINATOR))
    }

    #[inline]
    const fn weighted(&self, second: i64, first: i64, sum: i64) -> i64 {
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

    /// What a window makes of samples, the oldest first.
    pub(in crate::estimator) fn fits<const N: usize>(samples: &[i64]) -> Vec<(f64, f64)> {
        let mut window = Window::<N>::default();
        (samples.iter().enumerate())
            .map(|(index, &newest)| {
                let oldest = index.checked_sub(N).and_then(|i| samples.get(i)).copied().unwrap_or(0);
                window.push(newest, oldest);
                let value = window.value(newest) as f64 / Window::<N>::VALUE_DENOMINATOR as f64;
                (newest as f64 + value, window.slope() as f64 / Window::<N>::SLOPE_DENOMINATOR as f64)
            })
            .collect()
    }

    /// Weights of value and slope by age: the answer to a single sample of 1.
    pub(in crate::estimator) fn weights<const N: usize>() -> (Vec<f64>, Vec<f64>) {
        let samples: Vec<i64> = (0..2 * N).map(|i| i64::from(i == N)).collect();
        fits::<N>(&samples).into_iter().skip(N).take(N).unzip()
    }

    /// The fit by least squares in floating point, from the normal equations' closed form over all samples.
    fn oracle<const N: usize>(samples: &[i64]) -> (f64, f64) {
        let n = N as f64;
        let (mut value, mut slope) = (0.0, 0.0);
        for (age, &sample) in samples.iter().rev().take(N).enumerate() {
            let k = age as f64;
            let p1 = 2.0 * k - (n - 1.0);
            let p2 = 6.0 * k * k - 6.0 * (n - 1.0) * k + (n - 1.0) * (n - 2.0);
            value += sample as f64
                * 3.0
                * (3.0 * n * n - 3.0 * n + 2.0 - 6.0 * (2.0 * n - 1.0) * k + 10.0 * k * k);
            slope += sample as f64 * (5.0 * (n - 1.0) * p2 - (n * n - 4.0) * p1);
        }
        let den = n * (n * n - 1.0) * (n * n - 4.0) / 6.0;
        (value / (n * (n + 1.0) * (n + 2.0)), slope / den)
    }

    fn exact_on_parabolas<const N: usize>(offset: i64, speed: i64, half_acceleration: i64) {
        let parabola = |t: i64| offset + speed * t + half_acceleration * t * t;
        // Something wild before: it must have left no trace.
        let wild = (0..5).map(|i| i64::from(i32::MAX) * (i % 2));
        let samples: Vec<i64> = wild.chain((1 - N as i64..=0).map(parabola)).collect();
        assert_eq!(fits::<N>(&samples).last(), Some(&(offset as f64, speed as f64)));
    }

    proptest! {
        #[test]
        fn a_parabola_is_fitted_exactly(offset in -90_000_000..90_000_000_i64, speed in -200_000..200_000_i64, half in -2000..2000_i64) {
            exact_on_parabolas::<24>(offset, speed, half);
            exact_on_parabolas::<36>(offset, speed, half);
            exact_on_parabolas::<64>(offset, speed, half);
        }

        #[test]
        fn any_samples_are_fitted_as_in_floating_point(samples in prop::collection::vec(-200_000_000..200_000_000_i64, 64..150)) {
            let (value, slope) = oracle::<64>(&samples);
            let found = fits::<64>(&samples).pop().unwrap();
            prop_assert!((found.0 - value).abs() < 1e-3 && (found.1 - slope).abs() < 1e-3, "{:?} {} {}", found, value, slope);
            let (value, slope) = oracle::<24>(&samples);
            let found = fits::<24>(&samples).pop().unwrap();
            prop_assert!((found.0 - value).abs() < 1e-3 && (found.1 - slope).abs() < 1e-3, "{:?} {} {}", found, value, slope);
        }
    }

    #[test]
    fn no_fit_of_a_window_in_use_overflows() {
        fn largest<const N: usize>() -> f64 {
            let (value, slope) = weights::<N>();
            let sum = |w: &[f64], den: i64| w.iter().map(|w| w.abs()).sum::<f64>() * den as f64;
            sum(&value, Window::<N>::VALUE_DENOMINATOR).max(sum(&slope, Window::<N>::SLOPE_DENOMINATOR))
        }
        for largest in [largest::<24>(), largest::<36>(), largest::<64>()] {
            assert!(largest < f64::from(1 << 26), "{largest}");
        }
    }
}
