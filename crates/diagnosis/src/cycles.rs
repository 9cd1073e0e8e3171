//! Cycles of a motion: what repeats from one to the next is no noise.

/// Hysteresis of the cycle finder, as a share of the motion's range.
const HYSTERESIS: f64 = 0.2;

/// Cycles since the first upward crossing of the middle of the motion, from at least two such crossings; the mean
/// period serves before the first and after the last.
pub(crate) fn phases(time_s: &[f64], position: &[f64]) -> Option<Vec<f64>> {
    let low = position.iter().copied().fold(f64::INFINITY, f64::min);
    let high = position.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let (middle, margin) = (0.5 * (low + high), HYSTERESIS * (high - low));
    let mut crossings: Vec<f64> = Vec::new();
    let (mut armed, mut last) = (false, None);
    for (pair, times) in position.windows(2).zip(time_s.windows(2)) {
        let (&[x0, x1], &[t0, t1]) = (pair, times) else { continue };
        if x0 < middle - margin {
            armed = true;
        }
        if x0 <= middle && x1 > middle {
            last = Some(t0 + (t1 - t0) * (middle - x0) / (x1 - x0));
        }
        if armed && x1 > middle + margin {
            armed = false;
            crossings.extend(last.take());
        }
    }
    let (&first, &final_) = (crossings.first()?, crossings.last()?);
    if crossings.len() < 2 || margin <= 0.0 {
        return None;
    }
    let intervals = (crossings.len() - 1) as f64;
    let period = (final_ - first) / intervals;
    let phase = |t: f64| {
        if t < first {
            (t - first) / period
        } else if t >= final_ {
            intervals + (t - final_) / period
        } else {
            let i = crossings.partition_point(|&c| c <= t).max(1);
            let (a, b) = (crossings[i - 1], crossings.get(i).copied().unwrap_or(final_ + period));
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
        // Triangle strokes whose cycles last 2, 3 and 2 s.
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
