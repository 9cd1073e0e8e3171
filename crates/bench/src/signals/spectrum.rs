//! Random course with the spectrum of a sea state: a sum of harmonics with random phases.
//!
//! `S(f) ~ f^-5 exp(-1.25 (f_p/f)^4)` (Pierson and Moskowitz, J. Geophys. Res. 69, 1964) times
//! `gamma^exp(-(f - f_p)^2/(2 s^2 f_p^2))`, `s = .07` below and `.09` above the peak (JONSWAP,
//! Hasselmann et al., 1973). Harmonics lie between half and three times the peak frequency, one at
//! a random place in each of [`LINES`] equal intervals, so that the course does not repeat. Their
//! sum is scaled to the significant height, four times the rms. A spline through [`NODES`] samples
//! per peak period carries it.

use super::{Motion, spline};
use core::f64::consts::TAU;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Number of harmonics.
const LINES: usize = 200;
/// Lowest and highest frequency, as multiples of the peak frequency.
const SPAN: (f64, f64) = (0.5, 3.0);
/// Nodes per peak period: 40 per period of the highest harmonic.
const NODES: f64 = 120.0;

/// Spectrum of a sea state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SeaState {
    /// Significant height: four times the rms.
    pub(crate) height: f64,
    /// Peak period in s.
    pub(crate) peak_period_s: f64,
    /// Peak enhancement; 1: Pierson and Moskowitz.
    pub(crate) peak_enhancement: f64,
    /// Seed of phases and frequencies.
    pub(crate) seed: u64,
}

/// Harmonic `amplitude cos(2 pi frequency t + phase)`.
#[derive(Clone, Copy, Debug)]
struct Harmonic {
    amplitude: f64,
    frequency_hz: f64,
    phase_rad: f64,
}

impl SeaState {
    /// Spectral density at a frequency, without scale.
    fn density(&self, frequency_hz: f64) -> f64 {
        let ratio = frequency_hz * self.peak_period_s;
        let width = if ratio <= 1.0 { 0.07 } else { 0.09 };
        let peak = (-0.5 * ((ratio - 1.0) / width).powi(2)).exp();
        ratio.powi(-5) * (-1.25 * ratio.powi(-4)).exp() * self.peak_enhancement.powf(peak)
    }

    /// Harmonics with their amplitudes.
    fn harmonics(&self) -> Vec<Harmonic> {
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        let mut unit = || (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        let interval_hz = (SPAN.1 - SPAN.0) / self.peak_period_s / LINES as f64;
        let mut harmonics: Vec<Harmonic> = (0..LINES)
            .map(|line| {
                let frequency_hz = SPAN.0 / self.peak_period_s + (line as f64 + unit()) * interval_hz;
                Harmonic {
                    amplitude: self.density(frequency_hz).sqrt(),
                    frequency_hz,
                    phase_rad: TAU * unit(),
                }
            })
            .collect();
        let power = harmonics.iter().map(|h| 0.5 * h.amplitude * h.amplitude).sum::<f64>();
        let scale = 0.25 * self.height / power.sqrt();
        harmonics.iter_mut().for_each(|h| h.amplitude *= scale);
        harmonics
    }

    /// Times and nodes of the course from 0 to an end.
    pub(crate) fn nodes(&self, end_s: f64) -> (Vec<f64>, Vec<Motion>) {
        let harmonics = self.harmonics();
        let step_s = self.peak_period_s / NODES;
        let count = (end_s / step_s).ceil() as usize + 2;
        let times: Vec<f64> = (0..count).map(|i| i as f64 * step_s).collect();
        let value = |t: &f64| {
            harmonics
                .iter()
                .map(|h| h.amplitude * (TAU * h.frequency_hz * t + h.phase_rad).cos())
                .sum::<f64>()
        };
        let values: Vec<f64> = times.iter().map(value).collect();
        let nodes = spline::open(&times, &values);
        (times, nodes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signals::Profile;

    fn sea(peak_enhancement: f64, seed: u64) -> SeaState {
        SeaState { height: 2.0, peak_period_s: 8.0, peak_enhancement, seed }
    }

    fn moment(sea: &SeaState, order: i32) -> f64 {
        sea.harmonics().iter().map(|h| 0.5 * h.amplitude * h.amplitude * h.frequency_hz.powi(order)).sum()
    }

    #[test]
    fn the_course_has_the_significant_height_and_the_known_zero_crossing_period() {
        // For the full spectrum of Pierson and Moskowitz T_z = 0.710 T_p, for JONSWAP with 3.3
        // 0.777 T_p; without the tail beyond 3 f_p both are longer.
        for (peak_enhancement, least, most) in [(1.0, 0.72, 0.76), (3.3, 0.78, 0.82)] {
            let sea = sea(peak_enhancement, 1);
            assert!((4.0 * moment(&sea, 0).sqrt() - 2.0).abs() < 1e-12);
            let ratio = (moment(&sea, 0) / moment(&sea, 2)).sqrt() / 8.0;
            assert!((least..most).contains(&ratio), "{peak_enhancement}: {ratio}");
            let (time_s, nodes) = sea.nodes(4000.0);
            let curve = Profile::Curve { time_s, nodes };
            let values: Vec<f64> = (0..40_000).map(|i| curve.at(0.1 * f64::from(i)).value).collect();
            let rms = (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt();
            assert!((4.0 * rms / 2.0 - 1.0).abs() < 0.02, "{rms}");
            let rising = values.windows(2).filter(|w| w[0] < 0.0 && w[1] >= 0.0).count() as f64;
            assert!((4000.0 / rising / 8.0 / ratio - 1.0).abs() < 0.06, "{rising} {ratio}");
        }
    }

    #[test]
    fn the_spline_follows_the_sum_of_its_harmonics() {
        let sea = sea(3.3, 5);
        let (time_s, nodes) = sea.nodes(100.0);
        let curve = Profile::Curve { time_s, nodes };
        for i in 1..900 {
            let t = 0.101 * f64::from(i) + 0.3;
            let sum = |f: &dyn Fn(&Harmonic, f64) -> f64| {
                sea.harmonics().iter().map(|h| f(h, TAU * h.frequency_hz * t + h.phase_rad)).sum::<f64>()
            };
            let found = curve.at(t);
            assert!((found.value - sum(&|h, x| h.amplitude * x.cos())).abs() < 1e-5, "{t}");
            let rate = sum(&|h, x| -h.amplitude * TAU * h.frequency_hz * x.sin());
            assert!((found.rate - rate).abs() < 1e-4, "{t}");
            let acceleration = sum(&|h, x| -h.amplitude * (TAU * h.frequency_hz).powi(2) * x.cos());
            assert!((found.acceleration - acceleration).abs() < 5e-3, "{t}: {found:?} {acceleration}");
        }
    }

    #[test]
    fn a_seed_gives_one_course_and_another_seed_another() {
        assert_eq!(sea(1.0, 3).nodes(20.0), sea(1.0, 3).nodes(20.0));
        assert_ne!(sea(1.0, 3).nodes(20.0), sea(1.0, 4).nodes(20.0));
    }
}
