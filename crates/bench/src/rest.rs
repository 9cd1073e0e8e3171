//! Where a measured axis stands still.
//!
//! Noise of a micrometre a second turns simulated bristles of a tenth of a micrometre round within a rest, and friction with them. An axis rests while its
//! estimated speed is within its own noise for a time longer than any window that it was estimated from, and its position is the same all the time
//! but for its own: a slow drift is none, nor is the end of a stroke.

use crate::motion::Motion;

/// Deviations of a speed that noise explains.
const SLOW: f64 = 4.0;
/// Deviations of the sum of squares that noise explains.
const STEADY: f64 = 4.0;

/// Stops the nodes of a curve wherever at least `least` of them rest. `deviations` are those of the nodes' rates, `noise` is that of
/// a value.
pub(crate) fn stop_at_rest(
    nodes: &mut [Motion],
    deviations: &[f64],
    (values, noise): (&[f64], f64),
    least: usize,
) {
    let is_slow = |(node, deviation): (&Motion, &f64)| node.rate.abs() <= SLOW * deviation;
    let slow: Vec<bool> = nodes.iter().zip(deviations).map(is_slow).collect();
    let mut from = 0;
    for stretch in slow.chunk_by(|a, b| a == b) {
        let places = from..from + stretch.len();
        from = places.end;
        if places.len() < least || stretch.first() != Some(&true) {
            continue;
        }
        let (Some(values), Some(nodes)) = (values.get(places.clone()), nodes.get_mut(places)) else { return };
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let square = values.iter().map(|v| ((v - mean) / noise).powi(2)).sum::<f64>();
        if square <= count + STEADY * (2.0 * count).sqrt() {
            nodes.fill(Motion { value: mean, ..Motion::default() });
        }
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

    fn stopped(at: impl Fn(f64) -> f64, rate: impl Fn(f64) -> f64) -> Vec<usize> {
        let (mut nodes, values) = nodes(at, rate);
        stop_at_rest(&mut nodes, &[2e-5; 200], (&values, 1e-6), 33);
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
        stop_at_rest(&mut nodes, &[2e-5; 200], (&values, 1e-6), 33);
        let mean = values.iter().sum::<f64>() / 200.0;
        assert!(nodes.iter().all(|n| *n == Motion { value: mean, ..Motion::default() }));
    }
}
