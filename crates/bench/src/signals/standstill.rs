//! Standstill of a measured axis.
//!
//! Noise of a micrometre per second reverses simulated bristles of a tenth of a micrometre during a
//! standstill, and friction with them. An axis counts as standing still under two conditions. Its
//! estimated speed must stay within its own noise for as long as the widest window of the estimate.
//! Its position must be constant within its noise over that time, so a slow drift is no standstill.
//! The end of a stroke may satisfy both. It is distinguished by half as many samples more on either
//! side: over them a stroke's end is a parabola, and a standstill is not.

use crate::signals::Motion;
use nalgebra::{Matrix3, Vector3};

/// Standard deviations up to which a speed or a curvature counts as noise.
const MAX_SLOW_DEVIATIONS: f64 = 4.0;
/// Standard deviations up to which a sum of squares counts as noise.
const MAX_STEADY_DEVIATIONS: f64 = 4.0;

/// Measured positions, with the standard deviation of their white noise.
#[derive(Clone, Copy)]
pub(crate) struct Positions<'a> {
    pub(crate) time_s: &'a [f64],
    pub(crate) values: &'a [f64],
    pub(crate) noise: f64,
}

/// Sets the nodes of a curve to standstill wherever at least `min_count` of them are at standstill.
/// `deviations` are the standard deviations of the nodes' rates.
pub(crate) fn hold_standstills(
    nodes: &mut [Motion],
    deviations: &[f64],
    positions: Positions<'_>,
    min_count: usize,
) {
    let is_slow = |(node, deviation): (&Motion, &f64)| node.rate.abs() <= MAX_SLOW_DEVIATIONS * deviation;
    let slow: Vec<bool> = nodes.iter().zip(deviations).map(is_slow).collect();
    let mut from = 0;
    for stretch in slow.chunk_by(|a, b| a == b) {
        let places = from..from + stretch.len();
        from = places.end;
        if places.len() < min_count || stretch.first() != Some(&true) {
            continue;
        }
        let margin = places.len() / 2;
        let wider = places.start.saturating_sub(margin)..(places.end + margin).min(nodes.len());
        let (Some(inner), Some(around)) = (positions.slice(places.clone()), positions.slice(wider)) else {
            return;
        };
        let mean = inner.values.iter().sum::<f64>() / inner.values.len() as f64;
        if inner.lie_on(|_| mean)
            && !around.lie_on_parabola()
            && let Some(nodes) = nodes.get_mut(places)
        {
            nodes.fill(Motion { value: mean, ..Motion::default() });
        }
    }
}

impl Positions<'_> {
    fn slice(&self, places: core::ops::Range<usize>) -> Option<Self> {
        let (time_s, values) = (self.time_s.get(places.clone())?, self.values.get(places)?);
        Some(Self { time_s, values, noise: self.noise })
    }

    /// Returns whether the positions lie on a curve over time, within their noise.
    fn lie_on(&self, curve: impl Fn(f64) -> f64) -> bool {
        let count = self.values.len() as f64;
        let scaled = self.time_s.iter().zip(self.values).map(|(t, v)| (v - curve(*t)) / self.noise);
        scaled.map(|o| o * o).sum::<f64>() <= count + MAX_STEADY_DEVIATIONS * (2.0 * count).sqrt()
    }

    /// Returns whether the positions lie on a parabola that is no line, within their noise.
    fn lie_on_parabola(&self) -> bool {
        let (Some(first), Some(last)) = (self.time_s.first(), self.time_s.last()) else { return false };
        let (middle, half) = (0.5 * (first + last), 0.5 * (last - first));
        let powers = |t: f64| {
            let u = (t - middle) / half;
            Vector3::new(1.0, u, u * u)
        };
        let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
        for (t, value) in self.time_s.iter().zip(self.values) {
            let row = powers(*t);
            matrix += row * row.transpose();
            right += row * *value;
        }
        let Some(inverse) = matrix.cholesky().map(|c| c.inverse()) else { return false };
        let parabola = inverse * right;
        parabola.z.abs() > MAX_SLOW_DEVIATIONS * self.noise * inverse.m33.max(0.0).sqrt()
            && self.lie_on(|t| powers(t).dot(&parabola))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nodes of a position at 200 samples per second, with noise of 1 um and 20 um/s.
    fn nodes(at: impl Fn(f64) -> f64, rate: impl Fn(f64) -> f64) -> (Vec<Motion>, Vec<f64>) {
        let ragged = |i: u32| (f64::from(i) * 0.618_034).fract() - 0.5;
        let time = |i: u32| 5e-3 * f64::from(i);
        let node = |i: u32| Motion { value: 0.0, rate: rate(time(i)) + 4e-5 * ragged(i), acceleration: 1e-3 };
        let values = (0..200).map(|i| at(time(i)) + 3e-6 * ragged(i)).collect();
        ((0..200).map(node).collect(), values)
    }

    fn stop(nodes: &mut [Motion], values: &[f64]) {
        let time_s: Vec<f64> = (0..200).map(|i| 5e-3 * f64::from(i)).collect();
        hold_standstills(nodes, &[2e-5; 200], Positions { time_s: &time_s, values, noise: 1e-6 }, 33);
    }

    fn stopped(at: impl Fn(f64) -> f64, rate: impl Fn(f64) -> f64) -> Vec<usize> {
        let (mut nodes, values) = nodes(at, rate);
        stop(&mut nodes, &values);
        (0..200).filter(|&i| nodes[i].rate == 0.0 && nodes[i].acceleration == 0.0).collect()
    }

    #[test]
    fn an_axis_is_stopped_only_at_standstills() {
        // Standstill from 0.2 to 0.6 s, and for thirty samples at the end.
        let away = |t: f64| if t < 0.2 { 0.2 - t } else { (t - 0.6).clamp(0.0, 0.25) };
        let slope = |t: f64| if t < 0.2 { -1.0 } else { f64::from(u8::from(t > 0.6 && t < 0.85)) };
        assert_eq!(stopped(away, slope), (40..=120).collect::<Vec<_>>());
        // A creep of 10 um/s, and the end of a stroke.
        assert!(stopped(|t| 1e-5 * t, |_| 1e-5).is_empty());
        assert!(stopped(|t| 5e-5 * (t - 0.5).powi(2), |t| 1e-4 * (t - 0.5)).is_empty());
    }

    #[test]
    fn a_standstill_is_set_to_its_mean_position() {
        let (mut nodes, values) = nodes(|_| 0.25, |_| 0.0);
        stop(&mut nodes, &values);
        let mean = values.iter().sum::<f64>() / 200.0;
        assert!(nodes.iter().all(|n| *n == Motion { value: mean, ..Motion::default() }));
    }
}
