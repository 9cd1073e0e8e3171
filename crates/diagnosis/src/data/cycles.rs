//! Cycles of a motion.

use super::tuning;
use crate::statistics::limits;

/// Cycles since the first upward crossing of the middle of the motion; `None` with fewer than two
/// such crossings. Before the first and after the last crossing the mean period applies.
pub(crate) fn phases(time_s: &[f64], position: &[f64]) -> Option<Vec<f64>> {
    let (low, high) = limits(position.iter().copied());
    let (middle, margin) = (0.5 * (low + high), tuning::CYCLE_HYSTERESIS * (high - low));
    let mut crossings: Vec<f64> = Vec::new();
    // A crossing counts once the motion has been below the hysteresis and then rises above it.
    let (mut has_been_below, mut last_crossing) = (false, None);
    for (pair, times) in position.windows(2).zip(time_s.windows(2)) {
        let (&[x0, x1], &[t0, t1]) = (pair, times) else { continue };
        if x0 < middle - margin {
            has_been_below = true;
        }
        if x0 <= middle && x1 > middle {
            last_crossing = Some(t0 + (t1 - t0) * (middle - x0) / (x1 - x0));
        }
        if has_been_below && x1 > middle + margin {
            has_been_below = false;
            crossings.extend(last_crossing.take());
        }
    }
    let (&first, &last) = (crossings.first()?, crossings.last()?);
    if crossings.len() < 2 || margin <= 0.0 {
        return None;
    }
    let intervals = (crossings.len() - 1) as f64;
    let period = (last - first) / intervals;
    let phase = |t: f64| {
        if t < first {
            (t - first) / period
        } else if t >= last {
            intervals + (t - last) / period
        } else {
            let i = crossings.partition_point(|&c| c <= t).max(1);
            let (a, b) = (crossings[i - 1], crossings.get(i).copied().unwrap_or(last + period));
            (i - 1) as f64 + (t - a) / (b - a)
        }
    };
    Some(time_s.iter().map(|&t| phase(t)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phases_count_uneven_strokes() {
        // Triangular strokes with cycles of 2, 3 and 2 s.
        let mut time = Vec::new();
        let mut position = Vec::new();
        let mut t0 = 0.0;
        for period in [2.0, 3.0, 2.0] {
            for i in 0..200 {
                let u = f64::from(i) / 200.0;
                time.push(t0 + u * period);
                position.push(if u < 0.5 { 2.0 * u } else { 2.0 - 2.0 * u });
            }
            t0 += period;
        }
        let phase = phases(&time, &position).unwrap();
        assert!((phase[50] - 0.0).abs() < 1e-9, "{}", phase[50]);
        assert!((phase[250] - 1.0).abs() < 1e-9 && (phase[450] - 2.0).abs() < 1e-9);
        assert!(phase.windows(2).all(|w| w[1] > w[0]));
    }

    #[test]
    fn a_single_stroke_has_no_phase() {
        let time: Vec<f64> = (0..100).map(f64::from).collect();
        assert!(phases(&time, &time).is_none());
        assert!(phases(&time, &vec![1.0; 100]).is_none());
    }
}
