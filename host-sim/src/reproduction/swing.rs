//! The journal's swing in the clearance circle: its frequency, and the frequency's dependence on a
//! parameter.
//!
//! Around a reversal the contact force turns, and the journal swings along the circle of radius `a
//! = D + d` like a pendulum. The frequency should therefore be proportional to `a^-1/2` and nearly
//! independent of everything else. Method: signal in the oscillation window less a parabola, Hann
//! window, highest point of the spectrum between [`MIN_PERIODS`] periods per window and
//! [`HIGHEST_HZ`]. The window contains 2 to 7 periods on bench B, so a frequency is accurate to a
//! few percent.

use crate::run::summary::{acceleration_reversals_s, oscillation_window_s};
use bench::description::TransmissionBench;
use bench::plants::transmission::Snapshot;

/// Minimum number of periods in the window that count as an oscillation.
const MIN_PERIODS: f64 = 1.3;
/// Highest evaluated frequency, Hz.
const HIGHEST_HZ: f64 = 250.0;
/// Step of the frequency, Hz.
const STEP_HZ: f64 = 0.1;
/// Steps between the frequencies of the first pass. The window resolves 6 Hz or less, so a pass at
/// 1 Hz finds the highest maximum.
const COARSE_STEPS: usize = 10;

/// Swing of the journal after the first reversal.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Swing {
    /// Frequency of the journal's angle about the bearing's centre, Hz; none if it does not
    /// oscillate.
    pub swing_hz: Option<f64>,
    /// Frequency of the contact force, Hz; none if it does not oscillate.
    pub fluctuation_hz: Option<f64>,
    /// Mean distance of the journal's centre from the bearing's in the window, mm.
    pub swing_radius_mm: f64,
}

/// Measures the swing in the oscillation window of a run.
pub fn measure(bench: &TransmissionBench, samples: &[Snapshot], rate_hz: f64) -> Swing {
    let Some(reversal) = acceleration_reversals_s(bench).first().copied() else { return Swing::default() };
    within_window(samples, rate_hz, oscillation_window_s(bench, reversal))
}

/// Measures the swing between two times.
pub(super) fn within_window(samples: &[Snapshot], rate_hz: f64, window_s: (f64, f64)) -> Swing {
    let window = within(samples, window_s);
    let mut turns = 0.0;
    let mut last = None;
    let angles: Vec<f64> = window
        .iter()
        .map(|s| {
            let angle = s.z_m.atan2(s.y_m);
            if let Some(before) = last.replace(angle) {
                turns -= ((angle - before) / core::f64::consts::TAU).round();
            }
            angle + core::f64::consts::TAU * turns
        })
        .collect();
    let forces: Vec<f64> = window.iter().map(|s| s.forces.normal_n).collect();
    let radii: f64 = window.iter().map(|s| s.y_m.hypot(s.z_m)).sum();
    Swing {
        swing_hz: dominant_hz(&angles, rate_hz),
        fluctuation_hz: dominant_hz(&forces, rate_hz),
        swing_radius_mm: 1e3 * radii / window.len().max(1) as f64,
    }
}

/// Frequency of the contact force between two times, Hz; none if it does not oscillate.
pub(super) fn fluctuation_hz(samples: &[Snapshot], rate_hz: f64, window_s: (f64, f64)) -> Option<f64> {
    let forces: Vec<f64> = within(samples, window_s).iter().map(|s| s.forces.normal_n).collect();
    dominant_hz(&forces, rate_hz)
}

/// Samples between two times, both included.
fn within(samples: &[Snapshot], (from_s, to_s): (f64, f64)) -> &[Snapshot] {
    let low = samples.partition_point(|s| s.time_s < from_s);
    let high = samples.partition_point(|s| s.time_s <= to_s);
    samples.get(low..high).unwrap_or_default()
}

/// Frequency with the largest power in evenly spaced values less a parabola; none without a peak
/// inside the band.
fn dominant_hz(values: &[f64], rate_hz: f64) -> Option<f64> {
    let count = values.len();
    if count < 16 {
        return None;
    }
    let residual = subtract_parabola(values);
    let turn = core::f64::consts::TAU;
    let windowed: Vec<f64> = residual
        .iter()
        .enumerate()
        .map(|(i, v)| v * (0.5 - 0.5 * (turn * i as f64 / (count - 1) as f64).cos()))
        .collect();
    let power = |hz: f64| {
        // Goertzel: one recurrence a frequency.
        let coefficient = 2.0 * (turn * hz / rate_hz).cos();
        let (a, b) = windowed.iter().fold((0.0, 0.0), |(a, b), v| (v + coefficient * a - b, a));
        a * a + b * b - coefficient * a * b
    };
    let lowest = MIN_PERIODS * rate_hz / count as f64;
    let steps = ((HIGHEST_HZ.min(0.4 * rate_hz) - lowest) / STEP_HZ) as usize;
    let highest = |indices: &mut dyn Iterator<Item = usize>| {
        let powers = indices.map(|i| (i, power(lowest + STEP_HZ * i as f64)));
        powers.max_by(|a, b| a.1.total_cmp(&b.1))
    };
    let (coarse, _) = highest(&mut (0..=steps).step_by(COARSE_STEPS).chain([steps]))?;
    let near = coarse.saturating_sub(COARSE_STEPS)..=(coarse + COARSE_STEPS).min(steps);
    let (index, _) = highest(&mut near.into_iter()).filter(|(_, p)| *p > 0.0)?;
    // A maximum at the edge of the band belongs to a slower signal.
    (index > 0 && index < steps).then_some(lowest + STEP_HZ * index as f64)
}

/// Removes the parabola of least squares, in the orthogonal polynomials of evenly spaced points.
fn subtract_parabola(values: &[f64]) -> Vec<f64> {
    let count = values.len() as f64;
    let place = |i: usize| 2.0 * i as f64 / (count - 1.0) - 1.0;
    let mean_square = (0..values.len()).map(|i| place(i) * place(i)).sum::<f64>() / count;
    let bases: [&dyn Fn(f64) -> f64; 3] = [&|_| 1.0, &|x| x, &|x| x * x - mean_square];
    let mut residual = values.to_vec();
    for basis in bases {
        let norm: f64 = (0..residual.len()).map(|i| basis(place(i)).powi(2)).sum();
        let share = residual.iter().enumerate().map(|(i, v)| v * basis(place(i))).sum::<f64>() / norm;
        for (i, v) in residual.iter_mut().enumerate() {
            *v -= share * basis(place(i));
        }
    }
    residual
}

/// Exponent `p` and factor `c` of `y = c x^p` through positive points by least squares of the
/// logarithms; none with fewer than two different points.
pub fn power_law(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    let logs: Vec<(f64, f64)> =
        points.iter().filter(|(x, y)| *x > 0.0 && *y > 0.0).map(|(x, y)| (x.ln(), y.ln())).collect();
    let count = logs.len() as f64;
    let (mx, my) = logs.iter().fold((0.0, 0.0), |(a, b), (x, y)| (a + x / count, b + y / count));
    let (sxx, sxy) =
        logs.iter().fold((0.0, 0.0), |(a, b), (x, y)| (a + (x - mx) * (x - mx), b + (x - mx) * (y - my)));
    (sxx > 0.0).then(|| (sxy / sxx, (my - sxy / sxx * mx).exp()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_tone_on_a_parabola_is_found(
            hz in 20.0..200.0_f64,
            a in -5.0..5.0_f64,
            b in -5.0..5.0_f64,
            phase in 0.0..6.2_f64,
        ) {
            let values: Vec<f64> = (0..1500)
                .map(|i| f64::from(i) * 1e-4)
                .map(|t| {
                    let tone = (core::f64::consts::TAU * hz * t + phase).sin();
                    a + b * t / 0.15 + a * (t / 0.15).powi(2) + tone
                })
                .collect();
            let found = dominant_hz(&values, 10_000.0).unwrap();
            prop_assert!((found / hz - 1.0).abs() < 0.05, "{found} for {hz}");
        }

        #[test]
        fn a_power_law_is_recovered(p in -2.0..2.0_f64, c in 0.1..10.0_f64) {
            let points: Vec<(f64, f64)> =
                [0.1, 0.25, 0.5, 1.0_f64].iter().map(|x| (*x, c * x.powf(p))).collect();
            let (found, factor) = power_law(&points).unwrap();
            prop_assert!((found - p).abs() < 1e-9 && (factor / c - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn a_signal_without_oscillation_has_no_frequency() {
        assert_eq!(dominant_hz(&vec![3.0; 1500], 10_000.0), None);
        assert_eq!(dominant_hz(&[1.0, 2.0], 10_000.0), None);
        let step: Vec<f64> = (0..1500).map(|i| (f64::from(i) / 750.0 - 1.0).powi(3)).collect();
        assert_eq!(dominant_hz(&step, 10_000.0), None);
        assert_eq!(power_law(&[(1.0, 2.0)]), None);
    }
}
