//! Value and slope of a sampled quantity: a parabola fitted by least squares to the last [`WINDOW`] samples, read at the newest.
//!
//! A straight line would delay the slope by half its window, while the journal swings in its clearance at 30 to 65 Hz; the parabola
//! has no delay for a constant acceleration and pays with noise. Root mean square error of the rate on a bench
//! with 0.2 um of sensor noise at 10 kHz, swinging at 45 Hz with 0.35 mm/s (Babbitt) and 1.0 mm/s (plastic):
//!
//! | fit | samples | noise, mm/s | error at 30, 45, 65 Hz | Babbitt, mm/s | plastic, mm/s |
//! |---|---|---|---|---|---|
//! | line | 16 | 0.108 | 14, 21, 30 % | 0.131 | 0.237 |
//! | line | 20 | 0.078 | 18, 27, 38 % | 0.121 | 0.278 |
//! | parabola | 28 | 0.181 | 3, 6, 12 % | 0.182 | 0.190 |
//! | **parabola** | **36** | **0.125** | **4, 9, 19 %** | **0.130** | **0.157** |
//! | parabola | 44 | 0.093 | 6, 14, 29 % | 0.106 | 0.170 |
//! | parabola | 64 | 0.053 | 14, 30, 59 % | 0.117 | 0.303 |
//!
//! Of 20 to 72 samples, 36 gave the least force error over a whole cycle of bench B with either bearing.
//!
//! Noise gains at 36 samples: value 0.473; slope 0.0626 of one sample's noise per sample.
//!
//! The sums are exact integers; the first rounding is their conversion to f32. The weights come from the discrete orthogonal
//! polynomials `p1 = 2k - (N-1)` and `p2 = 6k^2 - 6(N-1)k + (N-1)(N-2)` over the age `k`.

/// Samples in the window. See the module's table for the trade-off.
pub const WINDOW: usize = 36;

const N: i64 = WINDOW as i64;

/// Numerators of the value's weights by age, over [`VALUE_DENOMINATOR`].
#[expect(clippy::indexing_slicing, reason = "evaluated by the compiler, which would refuse it")]
const VALUE: [i32; WINDOW] = {
    let mut weights = [0; WINDOW];
    let mut k = 0;
    while k < WINDOW {
        let age = k as i64;
        weights[k] = (3 * (3 * N * N - 3 * N + 2 - 6 * (2 * N - 1) * age + 10 * age * age)) as i32;
        k += 1;
    }
    weights
};
const VALUE_DENOMINATOR: f32 = (N * (N + 1) * (N + 2)) as f32;

/// Numerators of the slope's weights by age, over [`SLOPE_DENOMINATOR`] samples.
#[expect(clippy::indexing_slicing, reason = "evaluated by the compiler, which would refuse it")]
const SLOPE: [i32; WINDOW] = {
    let mut weights = [0; WINDOW];
    let mut k = 0;
    while k < WINDOW {
        let age = k as i64;
        let p1 = 2 * age - (N - 1);
        let p2 = 6 * age * age - 6 * (N - 1) * age + (N - 1) * (N - 2);
        weights[k] = (5 * (N - 1) * p2 - (N * N - 4) * p1) as i32;
        k += 1;
    }
    weights
};
const SLOPE_DENOMINATOR: f32 = (N * (N * N - 1) * (N * N - 4) / 6) as f32;

/// The last samples of one quantity, the newest first.
#[derive(Clone, Debug)]
pub struct Window {
    samples: [i32; WINDOW],
}

/// What the window says about the newest sample's instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// The value less the newest raw sample, in the sample's unit.
    pub correction: f32,
    /// The slope, in the sample's unit per sample.
    pub slope: f32,
}

impl Default for Window {
    fn default() -> Self {
        Self { samples: [0; WINDOW] }
    }
}

impl Window {
    /// Takes a sample and drops the oldest.
    pub fn push(&mut self, sample: i32) {
        let mut carried = sample;
        for kept in &mut self.samples {
            carried = core::mem::replace(kept, carried);
        }
    }

    /// Fits the parabola. Means something once [`WINDOW`] samples have been pushed.
    ///
    /// Differences to the newest sample are taken modulo 2^32, so an angle may wrap. No sum overflows: weights stay below 2^20, so
    /// 36 terms below 2^57.
    #[must_use]
    pub fn fit(&self) -> Fit {
        let [newest, ..] = self.samples;
        let (mut value, mut slope) = (0_i64, 0_i64);
        for (sample, (value_weight, slope_weight)) in self.samples.iter().zip(VALUE.iter().zip(&SLOPE)) {
            let relative = i64::from(sample.wrapping_sub(newest));
            value = value.wrapping_add(relative.wrapping_mul(i64::from(*value_weight)));
            slope = slope.wrapping_add(relative.wrapping_mul(i64::from(*slope_weight)));
        }
        Fit { correction: value as f32 / VALUE_DENOMINATOR, slope: slope as f32 / SLOPE_DENOMINATOR }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::TAU;
    use proptest::prelude::*;

    fn filled(sample_at_age: impl Fn(i64) -> i32) -> Fit {
        let mut window = Window::default();
        for age in (0..N).rev() {
            window.push(sample_at_age(age));
        }
        window.fit()
    }

    proptest! {
        #[test]
        fn a_parabola_is_fitted_exactly(offset in -1_000_000..1_000_000_i32, speed in -2000..2000_i32, half_acceleration in -20..20_i32) {
            let fit = filled(|age| {
                let t = -i32::try_from(age).unwrap();
                offset + speed * t + half_acceleration * t * t
            });
            prop_assert_eq!(fit.correction, 0.0);
            prop_assert!((fit.slope - speed as f32).abs() <= 1e-6 * (speed as f32).abs(), "{} {}", fit.slope, speed);
        }

        #[test]
        fn an_angle_may_wrap(start in any::<i32>()) {
            let fit = filled(|age| start.wrapping_sub(100_000_i32.wrapping_mul(i32::try_from(age).unwrap())));
            prop_assert_eq!(fit, Fit { correction: 0.0, slope: 100_000.0 });
        }
    }

    /// Root of the summed squares of the weights: what white noise of one unit becomes.
    #[test]
    fn noise_gains_are_the_documented_ones() {
        let gain = |weights: &[i32], denominator: f32| {
            weights.iter().map(|w| (f64::from(*w) / f64::from(denominator)).powi(2)).sum::<f64>().sqrt()
        };
        assert!(
            (gain(&VALUE, VALUE_DENOMINATOR) - 0.473).abs() < 5e-4,
            "{}",
            gain(&VALUE, VALUE_DENOMINATOR)
        );
        let slope = gain(&SLOPE, SLOPE_DENOMINATOR);
        assert!((slope - 0.0626).abs() < 5e-5, "{slope}");
        let rate_noise_mm_s = slope * 0.2e-3 * 1e4;
        assert!((rate_noise_mm_s - 0.125).abs() < 5e-4, "{rate_noise_mm_s}");
    }

    /// A swing of 1 mm at 10 kHz sampling: the largest error of the slope over the largest slope.
    #[test]
    fn errors_at_the_journal_s_frequencies_are_the_documented_ones() {
        for (frequency, expected) in [(30.0, 0.04), (45.0, 0.09), (65.0, 0.19)] {
            let step = TAU * frequency / 1e4;
            let worst = (0..1000)
                .map(|i| {
                    let phase = f64::from(i) * TAU / 1000.0;
                    let fit = filled(|age| (1e6 * (phase - step * age as f64).sin()).round() as i32);
                    (f64::from(fit.slope) / (1e6 * step) - phase.cos()).abs()
                })
                .fold(0.0, f64::max);
            assert!((worst - expected).abs() < 0.006, "{frequency} Hz: {worst}");
        }
    }

    /// The journal far out in a wide clearance must not cost the fit its nanometres.
    #[test]
    fn an_offset_of_millimetres_costs_no_resolution() {
        let wave = |age: i64| (300.0 * (age as f64 * 0.37).sin()).round() as i32;
        assert_eq!(filled(wave), filled(|age| wave(age) + 5_000_000));
    }
}
