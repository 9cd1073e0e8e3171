//! Where a measured axis stands still.
//!
//! Noise of a micrometre a second turns simulated bristles of a tenth of a micrometre round within a rest, and friction with them. An axis rests while its
//! estimated speed is within its own noise for as long as the widest window that it was estimated from, and its position is the same all the time
//! but for its own: a slow drift is none. Nor is the end of a stroke, which for as long may keep within the noise: with half as much again
//! on either side it is a parabola, where motion that sets out from a rest is none.

use crate::motion::Motion;
use nalgebra::{Matrix3, Vector3};

/// Deviations of a speed or of a curvature that noise explains.
const SLOW: f64 = 4.0;
/// Deviations of the sum of squares that noise explains.
const STEADY: f64 = 4.0;

/// Measured positions, with the deviation of their white noise.
#[derive(Clone, Copy)]
pub(crate) struct Positions<'a> {
    pub(crate) time_s: &'a [f64],
    pub(crate) values: &'a [f64],
    pub(crate) noise: f64,
}

/// Stops the nodes of a curve wherever at least `least` of them rest. `deviations` are those of the nodes' rates.
pub(crate) fn stop_at_rest(nodes: &mut [Motion], deviations: &[f64], positions: Positions<'_>, least: usize) {
    let is_slow = |(node, deviation): (&Motion, &f64)| node.rate.abs() <= SLOW * deviation;
    let slow: Vec<bool> = nodes.iter().zip(deviations).map(is_slow).collect();
    let mut from = 0;
    for stretch in slow.chunk_by(|a, b| a == b) {
        let places = from..from + stretch.len();
        from = places.end;
        if places.len() < least || stretch.first() != Some(&true) {
            continue;
        }
        let margin = places.len() / 2;
        let wider = places.start.saturating_sub(margin)..(places.end + margin).min(nodes.len());
        let (Some(rest), Some(around)) = (positions.within(places.clone()), positions.within(wider)) else {
            return;
        };
        let mean = rest.values.iter().sum::<f64>() / rest.values.len() as f64;
        if rest.are(|_| mean)
            && !around.turn()
            && let Some(nodes) = nodes.get_mut(places)
        {
            nodes.fill(Motion { value: mean, ..Motion::default() });
        }
    }
}

impl Positions<'_> {
    fn within(&self, places: core::ops::Range<usize>) -> Option<Self> {
        let (time_s, values) = (self.time_s.get(places.clone())?, self.values.get(places)?);
        Some(Self { time_s, values, noise: self.noise })
    }

    /// Whether they are a curve over time but for their noise.
    fn are(&self, curve: impl Fn(f64) -> f64) -> bool {
        let count = self.values.len() as f64;
        let off = self.time_s.iter().zip(self.values).map(|(t, v)| (v - curve(*t)) / self.noise);
        off.map(|o| o * o).sum::<f64>() <= count + STEADY * (2.0 * count).sqrt()
    }

    /// Whether they are a parabola, and no line, but for their noise.
    fn turn(&self) -> bool {
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
        parabola.z.abs() > SLOW * self.noise * inverse.m33.max(0.0).sqrt()
            && self.are(|t| powers(t).dot(&parabola))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nodes of a position at 200 samples a second, noise of a micrometre and of 20 um/s.
    fn nodes(at: impl Fn(f64) -> f64, rate: impl Fn(f64) -> f64) -> (Vec<Motion>, Vec<f64>) {
        let ragged = |i: u32| (f64::from(i) * 0.618_034).fract() - 0.5;
        let time = |i: u32| 5e-3 * f64::from(i);
        let node = |i: u32| Motion { value: 0.0, rate: rate(time(i)) + 4e-5 * ragged(i), acceleration: 1e-3 };
        let values = (0..200).map(|i| at(time(i)) + 3e-6 * ragged(i)).collect();
        ((0..200).map(node).collect(), values)
    }

    fn stop(nodes: &mut [Motion], values: &[f64]) {
        let time_s: Vec<f64> = (0..200).map(|i| 5e-3 * f64::from(i)).collect();
        stop_at_rest(nodes, &[2e-5; 200], Positions { time_s: &time_s, values, noise: 1e-6 }, 33);
    }

    fn stopped(at: impl Fn(f64) -> f64, rate: impl Fn(f64) -> f64) -> Vec<usize> {
        let (mut nodes, values) = nodes(at, rate);
        stop(&mut nodes, &values);
        (0..200).filter(|&i| nodes[i].rate == 0.0 && nodes[i].acceleration == 0.0).collect()
    }

    #[test]
    fn an_axis_stops_where_it_rests_and_nowhere_else() {
        // At rest from .2 to .6 s, and for as long as thirty samples at the end.
        let away = |t: f64| if t < 0.2 { 0.2 - t } else { (t - 0.6).clamp(0.0, 0.25) };
        let slope = |t: f64| if t < 0.2 { -1.0 } else { f64::from(u8::from(t > 0.6 && t < 0.85)) };
        assert_eq!(stopped(away, slope), (40..=120).collect::<Vec<_>>());
        // A creep of 10 um/s, the end of a stroke.
        assert!(stopped(|t| 1e-5 * t, |_| 1e-5).is_empty());
        assert!(stopped(|t| 5e-5 * (t - 0.5).powi(2), |t| 1e-4 * (t - 0.5)).is_empty());
    }

    #[test]
    fn a_rest_lies_at_its_mean() {
        let (mut nodes, values) = nodes(|_| 0.25, |_| 0.0);
        stop(&mut nodes, &values);
        let mean = values.iter().sum::<f64>() / 200.0;
        assert!(nodes.iter().all(|n| *n == Motion { value: mean, ..Motion::default() }));
    }
}
