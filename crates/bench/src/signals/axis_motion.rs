//! Motion of an axis from its measured position and speed, smoothed only as far as the noise
//! requires.
//!
//! Friction changes its sign within a sliding speed of millimetres per second. An axis that starts
//! from standstill passes that range in a few samples. A speed that is wrong by a hundredth of that
//! range causes an error of the force that repeats in every cycle, while noise averages out. So the
//! bias must stay below the noise at every sample.
//!
//! At each sample a cubic is fitted to ever wider windows. Position and speed are weighted by their
//! own white noise. Speed and acceleration are each taken from the widest window that contradicts
//! no narrower one. For two fits to nested samples the variance of the difference is the difference
//! of the variances (Hausman), so noise alone moves an estimate by about the root of that. A larger
//! change is motion. Choice of the window: Goldenshluger and Nemirovski 1997, "intersection of
//! confidence intervals".
//!
//! At standstill the speed is set to zero ([`crate::signals::standstill`]); a position shows a
//! standstill, a speed alone does not. A speed that is measured well stays nearly as measured, and
//! only the acceleration is smoothed. Units: those of the log. Limit: if only a position is
//! measured and it is noisy within the time of a sign change, an error remains there that no window
//! can remove.

use crate::signals::standstill::{Positions, hold_standstills};
use crate::signals::white_noise;
use crate::signals::{Motion, Profile};
use nalgebra::{Matrix4, Vector4};

/// Half windows in samples, ascending.
const HALF_WINDOWS: [usize; 8] = [1, 2, 3, 4, 6, 8, 12, 16];
/// Standard deviations by which noise alone may move the estimates of two windows apart.
const AGREEMENT: f64 = 3.0;

/// Minimum number of samples of a standstill: those of the widest window.
const STANDSTILL_SAMPLES: usize = 2 * HALF_WINDOWS[HALF_WINDOWS.len() - 1] + 1;

/// Estimate with its standard deviation.
type Estimate = (f64, f64);

/// Index of the widest window whose estimate agrees with those of all narrower windows.
fn widest(estimates: &[Estimate]) -> Option<usize> {
    let agrees = |k: usize| {
        let Some(&(wide, wide_deviation)) = estimates.get(k) else { return false };
        estimates.iter().take(k).all(|(narrow, deviation)| {
            let noise = (deviation * deviation - wide_deviation * wide_deviation).max(0.0).sqrt();
            (wide - narrow).abs() <= AGREEMENT * noise
        })
    };
    (0..estimates.len()).take_while(|&k| agrees(k)).last()
}

/// Normal equations of a cubic around a sample, in units of a step; samples are added one by one.
struct Cubic {
    matrix: Matrix4<f64>,
    right: Vector4<f64>,
}

impl Cubic {
    fn add(&mut self, row: Vector4<f64>, right: f64) {
        self.matrix += row * row.transpose();
        self.right += right * row;
    }
}

/// Returns the curve of an axis through measured positions and, where given, speeds.
pub(crate) fn follow(time_s: &[f64], positions: &[f64], speeds: Option<&[f64]>) -> Profile {
    let (mut nodes, deviations): (Vec<Motion>, Vec<f64>) =
        nodes(time_s, positions, speeds).into_iter().unzip();
    let noise = white_noise::estimate(time_s, positions);
    hold_standstills(
        &mut nodes,
        &deviations,
        Positions { time_s, values: positions, noise },
        STANDSTILL_SAMPLES,
    );
    curve(time_s, nodes)
}

/// Returns the curve of a speed that was measured without a position. A constant speed is no
/// standstill.
pub(crate) fn smoothed(time_s: &[f64], speeds: &[f64]) -> Profile {
    curve(time_s, nodes(time_s, speeds, None).into_iter().map(|(node, _)| node).collect())
}

fn curve(time_s: &[f64], nodes: Vec<Motion>) -> Profile {
    Profile::Curve { time_s: time_s.get(..nodes.len()).unwrap_or(time_s).to_vec(), nodes }
}

/// Motion at every sample from the widest agreeing windows, with the standard deviation of its
/// rate.
fn nodes(time_s: &[f64], values: &[f64], rates: Option<&[f64]>) -> Vec<(Motion, f64)> {
    let count = time_s.len().min(values.len()).min(rates.map_or(usize::MAX, <[f64]>::len));
    let span = time_s.last().zip(time_s.first()).map_or(0.0, |(b, a)| b - a);
    let step = (span / count.saturating_sub(1).max(1) as f64).max(f64::MIN_POSITIVE);
    let value_weight = 1.0 / white_noise::estimate(time_s, values);
    let rates = rates.map(|r| (r, 1.0 / (step * white_noise::estimate(time_s, r))));
    let node = |i: usize| {
        let (Some(&centre), Some(&base)) = (time_s.get(i), values.get(i)) else {
            return (Motion::default(), 0.0);
        };
        let mut cubic = Cubic { matrix: Matrix4::zeros(), right: Vector4::zeros() };
        let add = |cubic: &mut Cubic, k: usize| {
            let (Some(t), Some(value)) = (time_s.get(k), values.get(k)) else { return };
            let u = (t - centre) / step;
            cubic.add(value_weight * Vector4::new(1.0, u, u * u, u * u * u), value_weight * (value - base));
            if let Some((rate, weight)) = rates.and_then(|(r, weight)| Some((r.get(k)?, weight))) {
                cubic.add(weight * Vector4::new(0.0, 1.0, 2.0 * u, 3.0 * u * u), weight * rate * step);
            }
        };
        add(&mut cubic, i);
        let mut done = 0;
        let (mut values_by_window, mut rates_by_window, mut accelerations_by_window) =
            (Vec::new(), Vec::new(), Vec::new());
        for half in HALF_WINDOWS {
            for k in done + 1..=half {
                if let Some(before) = i.checked_sub(k) {
                    add(&mut cubic, before);
                }
                if i + k < count {
                    add(&mut cubic, i + k);
                }
            }
            done = half;
            let samples = 1 + half.min(i) + half.min(count - 1 - i);
            // A window with no more readings than unknowns passes on all their noise, and amplifies
            // it at the ends, where it is one-sided.
            if samples * (1 + usize::from(rates.is_some())) <= 4 {
                continue;
            }
            let Some(inverse) = cubic.matrix.cholesky().map(|c| c.inverse()) else { continue };
            let solution = inverse * cubic.right;
            let deviation = |k: usize| inverse[(k, k)].max(0.0).sqrt();
            values_by_window.push((base + solution[0], deviation(0)));
            rates_by_window.push((solution[1] / step, deviation(1) / step));
            accelerations_by_window
                .push((2.0 * solution[2] / (step * step), 2.0 * deviation(2) / (step * step)));
        }
        let best = |estimates: &[Estimate], none: f64| {
            widest(estimates).and_then(|k| estimates.get(k)).copied().unwrap_or((none, 0.0))
        };
        let (rate, deviation) = best(&rates_by_window, 0.0);
        let motion = Motion {
            value: best(&values_by_window, base).0,
            rate,
            acceleration: best(&accelerations_by_window, 0.0).0,
        };
        (motion, deviation)
    };
    (0..count).map(node).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn the_peak_of_a_speed_without_a_position_is_preserved() {
        // A hundred samples per cycle. At a peak the slope of a speed is 0 in every window.
        let mut state = 5_u64;
        let mut noise = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            1e-4 * ((state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5)
        };
        let time_s: Vec<f64> = (0..400).map(|i| f64::from(i) * 0.01).collect();
        let speed: Vec<f64> = time_s.iter().map(|t| (core::f64::consts::TAU * t).sin() + noise()).collect();
        let curve = smoothed(&time_s, &speed);
        for peak_s in [1.25, 1.75, 2.25, 2.75] {
            let off = curve.at(peak_s).value.abs() - 1.0;
            assert!(off.abs() < 2e-4, "{peak_s}: {off}");
        }
    }

    /// Number of standstill nodes among 600 readings a millisecond apart, with unit noise.
    fn stopped(position: impl Fn(f64) -> f64, seed: u64) -> usize {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let time_s: Vec<f64> = (-300..300).map(|i| 1e-3 * f64::from(i)).collect();
        let noise = |_: &f64| -> f64 { StandardNormal.sample(&mut rng) };
        let noise: Vec<f64> = time_s.iter().map(noise).collect();
        let values: Vec<f64> = time_s.iter().zip(noise).map(|(t, noise)| position(1e3 * t) + noise).collect();
        let Profile::Curve { nodes, .. } = follow(&time_s, &values, None) else { return 0 };
        nodes.iter().filter(|n| n.rate == 0.0 && n.acceleration == 0.0).count()
    }

    #[test]
    fn the_end_of_a_slow_stroke_is_no_standstill() {
        // Peaks of ten thousand standard deviations. Their tops stay within the noise for 35 to 80
        // samples.
        for bend in [3e-3, 5e-3, 8e-3, 1.1e-2] {
            let stroke = |samples: f64| 1e4 * (samples * f64::sqrt(bend / 1e4)).cos();
            let rests: Vec<u64> = (0..8).filter(|seed| stopped(stroke, *seed) > 0).collect();
            assert!(rests.is_empty(), "{bend}: {rests:?}");
        }
    }

    #[test]
    fn standstills_between_motions_of_any_kind_are_found() {
        for bend in [0.05, 1.0, 20.0] {
            let away = |samples: f64| 0.5 * bend * (samples.abs() - 32.0).max(0.0).powi(2);
            for seed in 0..4 {
                let back = stopped(away, seed);
                let on = stopped(|samples| samples.signum() * away(samples), seed);
                let off = stopped(|samples| if samples < -32.0 { 0.0 } else { away(samples) }, seed);
                assert!([back, on].iter().all(|n| (40..=80).contains(n)), "{bend} {seed}: {back} {on}");
                assert!((310..=350).contains(&off), "{bend} {seed}: {off}");
            }
        }
    }

    #[test]
    fn the_first_and_the_last_reading_have_no_spurious_acceleration() {
        // 250 samples per second of a stroke of at most 1 rad/s2, read to 2e-6 rad and 5e-5 rad/s.
        let time_s: Vec<f64> = (0..60).map(|i| 4e-3 * f64::from(i)).collect();
        for seed in 0..500 {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let mut noise = || -> f64 { StandardNormal.sample(&mut rng) };
            let angle: Vec<f64> = time_s.iter().map(|t| 0.25 * (2.0 * t).sin() + 2e-6 * noise()).collect();
            let speed: Vec<f64> = time_s.iter().map(|t| 0.5 * (2.0 * t).cos() + 5e-5 * noise()).collect();
            let curve = follow(&time_s, &angle, Some(&speed));
            for t in [0.0, 0.236] {
                let off = curve.at(t).acceleration + (2.0 * t).sin();
                assert!(off.abs() < 0.2, "seed {seed}, {t} s: {off}");
            }
        }
    }
}
