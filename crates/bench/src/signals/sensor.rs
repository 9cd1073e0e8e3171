//! Effect of a sensor on a signal, in this order: bandwidth, delay, gain, offset, drift, limit,
//! noise, limit, resolution.

use crate::schema::section;
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

section! {
    /// One sensor. All values are in the unit of its channel, SI.
    #[derive(Copy)]
    Sensor {
        /// Standard deviation of white noise at the log's sample rate.
        #[serde(default)]
        noise: f64 [0.0, 1e12, "the channel's"],
        /// Step of the reading; 0: continuous.
        #[serde(default)]
        resolution: f64 [0.0, 1e12, "the channel's"],
        /// Delay.
        #[serde(default)]
        delay_s: f64 [-1e3, 1e3],
        /// Cut-off of a first-order low-pass; 0: none.
        #[serde(default)]
        bandwidth_hz: f64 [0.0, 1e12],
        /// Constant added to the reading.
        #[serde(default)]
        offset: f64 [-1e12, 1e12, "the channel's"],
        /// Factor of the reading.
        #[serde(default = "one")]
        gain: f64 [-1e12, 1e12],
        /// Change of the offset per second.
        #[serde(default)]
        drift_per_s: f64 [-1e12, 1e12, "the channel's per s"],
        /// Reciprocal of the largest reading of either sign; 0: no limit.
        #[serde(default, skip_serializing_if = "is_zero")]
        inverse_limit: f64 [0.0, 1e12, "1/the channel's"],
        /// Share of readings that external interference disturbs.
        #[serde(default, skip_serializing_if = "is_zero")]
        outlier_share: f64 [0.0, 1.0],
        /// Standard deviation of the disturbance.
        #[serde(default, skip_serializing_if = "is_zero")]
        outlier_size: f64 [0.0, 1e12, "the channel's"],
    }
}

fn one() -> f64 {
    1.0
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

impl Default for Sensor {
    fn default() -> Self {
        Self {
            noise: 0.0,
            resolution: 0.0,
            delay_s: 0.0,
            bandwidth_hz: 0.0,
            offset: 0.0,
            gain: 1.0,
            drift_per_s: 0.0,
            inverse_limit: 0.0,
            outlier_share: 0.0,
            outlier_size: 0.0,
        }
    }
}

impl Sensor {
    /// Returns the readings of the sensor's electronics for a true signal, without noise and
    /// resolution.
    ///
    /// Before the first sample the signal is taken as equal to the first sample.
    pub fn respond(&self, time_s: &[f64], truth: &[f64]) -> Vec<f64> {
        let mut signal = truth.to_vec();
        if self.bandwidth_hz > 0.0 {
            let rate = 2.0 * core::f64::consts::PI * self.bandwidth_hz;
            let mut previous = truth.first().copied().unwrap_or_default();
            let mut last_time = time_s.first().copied().unwrap_or_default();
            for (value, &t) in signal.iter_mut().zip(time_s) {
                previous += (*value - previous) * (1.0 - (-rate * (t - last_time)).exp());
                last_time = t;
                *value = previous;
            }
        }
        if self.delay_s != 0.0 {
            signal = time_s.iter().map(|&t| interpolate(time_s, &signal, t - self.delay_s)).collect();
        }
        let start = time_s.first().copied().unwrap_or_default();
        for (value, &t) in signal.iter_mut().zip(time_s) {
            *value = self.limited(self.gain * *value + self.offset + self.drift_per_s * (t - start));
        }
        signal
    }

    /// Returns whether a reading depends only on the signal at its own time.
    pub(crate) fn is_prompt(&self) -> bool {
        self.delay_s == 0.0 && self.bandwidth_hz <= 0.0
    }

    /// Adds noise and outliers and rounds to the resolution.
    pub fn read(&self, signal: &mut [f64], rng: &mut impl rand::Rng) {
        for value in signal {
            let draw: f64 = StandardNormal.sample(rng);
            *value += self.noise * draw;
            // Without outliers no random number is drawn for them, so that a seed gives the same
            // noise.
            if self.outlier_share > 0.0 && rng.random_bool(self.outlier_share.min(1.0)) {
                let draw: f64 = StandardNormal.sample(rng);
                *value += self.outlier_size * draw;
            }
            *value = self.limited(*value);
            if self.resolution > 0.0 {
                *value = (*value / self.resolution).round() * self.resolution;
            }
        }
    }

    /// Returns whether a reading is the largest that the sensor can give, of either sign.
    pub fn is_at_limit(&self, reading: f64) -> bool {
        // Rounding to the resolution may have moved it by half a step.
        self.inverse_limit > 0.0 && reading.abs() >= 1.0 / self.inverse_limit - 0.5 * self.resolution
    }

    fn limited(&self, value: f64) -> f64 {
        if self.inverse_limit > 0.0 {
            value.clamp(-1.0 / self.inverse_limit, 1.0 / self.inverse_limit)
        } else {
            value
        }
    }

    /// Standard deviation due to noise and resolution of a reading that is no outlier.
    pub fn floor(&self) -> f64 {
        (self.noise * self.noise + self.resolution * self.resolution / 12.0).sqrt()
    }
}

/// Interpolates in ascending `time_s` by the cubic through the two samples on either side, linearly
/// in the first and last interval. The end values hold outside.
///
/// Linear interpolation everywhere would reduce an oscillation by `(w h)^2/8`: 2 % at 65 Hz and 1
/// kHz, more than the sensors' noise on the bearing force.
pub(super) fn interpolate(time_s: &[f64], values: &[f64], at_s: f64) -> f64 {
    let after = time_s.partition_point(|&t| t <= at_s);
    if let Some(first) = after.checked_sub(2)
        && let (Some([t0, t1, t2, t3]), Some([v0, v1, v2, v3])) =
            (time_s.get(first..first + 4), values.get(first..first + 4))
    {
        let [a, b, c, d] = [at_s - t0, at_s - t1, at_s - t2, at_s - t3];
        return v0 * b * c * d / ((t0 - t1) * (t0 - t2) * (t0 - t3))
            + v1 * a * c * d / ((t1 - t0) * (t1 - t2) * (t1 - t3))
            + v2 * a * b * d / ((t2 - t0) * (t2 - t1) * (t2 - t3))
            + v3 * a * b * c / ((t3 - t0) * (t3 - t1) * (t3 - t2));
    }
    match (
        after.checked_sub(1).and_then(|i| Some((*time_s.get(i)?, *values.get(i)?))),
        time_s.get(after),
        values.get(after),
    ) {
        (Some((t0, v0)), Some(&t1), Some(&v1)) => v0 + (v1 - v0) * (at_s - t0) / (t1 - t0),
        (Some((_, v0)), ..) => v0,
        (None, _, Some(&v1)) => v1,
        (None, ..) => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_delayed_ramp_lags_by_the_delay() {
        let time: Vec<f64> = (0..100).map(|i| i as f64 * 1e-3).collect();
        let sensor = Sensor { delay_s: 0.0025, gain: 2.0, offset: 1.0, ..Sensor::default() };
        let out = sensor.respond(&time, &time);
        assert!((out[50] - (2.0 * (0.050 - 0.0025) + 1.0)).abs() < 1e-12);
        assert_eq!(out[0], 1.0);
    }

    #[test]
    fn a_delay_between_samples_keeps_an_oscillation() {
        let wave = |t: f64| (2.0 * core::f64::consts::PI * 50.0 * t).sin();
        let time: Vec<f64> = (0..200).filter(|i| i % 37 != 5).map(|i| i as f64 * 1e-3).collect();
        let truth: Vec<f64> = time.iter().map(|&t| wave(t)).collect();
        let sensor = Sensor { delay_s: 0.0025, ..Sensor::default() };
        let out = sensor.respond(&time, &truth);
        for (t, value) in time.iter().zip(&out).filter(|(t, _)| (0.01..0.19).contains(*t)) {
            assert!((value - wave(t - 0.0025)).abs() < 2e-3, "{value} at {t}");
        }
    }

    #[test]
    fn bandwidth_attenuates_by_the_first_order_gain() {
        let time: Vec<f64> = (0..20_000).map(|i| i as f64 * 1e-4).collect();
        let truth: Vec<f64> = time.iter().map(|t| (2.0 * core::f64::consts::PI * 50.0 * t).sin()).collect();
        let sensor = Sensor { bandwidth_hz: 50.0, ..Sensor::default() };
        let out = sensor.respond(&time, &truth);
        let peak = out[10_000..].iter().fold(0.0_f64, |m, v| m.max(*v));
        assert!((peak - 0.5_f64.sqrt()).abs() < 0.02, "{peak}");
    }
}
