//! Rainflow counting of a history (ASTM E1049-85, section 5.4.4).
//!
//! Cycles are found by the four-point rule: an inner range that is not larger than both of its
//! neighbours is a complete cycle and is removed. Ranges of the remaining sequence count as half
//! cycles. Both together give the counts of the standard.

/// A counted range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RangeCycle {
    /// Difference between the two turning points, positive.
    pub(crate) range: f64,
    /// 1 for a complete cycle, 0.5 for a half.
    pub(crate) count: f64,
    /// Indices in the history of its two turning points.
    pub(crate) ends: [usize; 2],
}

/// Sums a weight of the ranges over the cycles between `boundaries`, ascending indices in the
/// history. Half of a range belongs to the cycle of each of its turning points. Every turning point
/// of an almost periodic history is the end of one complete range, whichever its partner is, so the
/// sums of the cycles resemble each other.
pub(crate) fn sums_per_cycle(
    ranges: &[RangeCycle],
    boundaries: &[usize],
    weight: &dyn Fn(&RangeCycle) -> f64,
) -> Vec<f64> {
    let mut sums = vec![0.0; boundaries.len().saturating_sub(1)];
    for range in ranges {
        for end in range.ends {
            let cycle = boundaries.partition_point(|&start| start <= end).saturating_sub(1);
            if let Some(sum) = sums.get_mut(cycle) {
                *sum += 0.5 * weight(range);
            }
        }
    }
    sums
}

/// Turning points of a history with their indices: its ends and its local extremes.
fn turning_points(history: &[f64]) -> Vec<(usize, f64)> {
    let mut points: Vec<(usize, f64)> = Vec::new();
    for (index, &value) in history.iter().enumerate() {
        if let [.., (_, before), (_, last)] = points[..]
            && (last - before) * (value - last) >= 0.0
        {
            points.pop();
        }
        if points.last().is_none_or(|(_, last)| *last != value) {
            points.push((index, value));
        }
    }
    points
}

/// Counts the ranges of a history, in the order in which they end.
pub(crate) fn count(history: &[f64]) -> Vec<RangeCycle> {
    let mut cycles = Vec::new();
    let mut open: Vec<(usize, f64)> = Vec::new();
    for point in turning_points(history) {
        open.push(point);
        while let [.., (_, a), (start, b), (end, c), (_, d)] = open[..] {
            let inner = (c - b).abs();
            if inner > (b - a).abs() || inner > (d - c).abs() {
                break;
            }
            cycles.push(RangeCycle { range: inner, count: 1.0, ends: [start, end] });
            open.drain(open.len() - 3..open.len() - 1);
        }
    }
    let halves = open.windows(2).filter_map(|pair| match pair {
        [(start, from), (end, to)] => {
            Some(RangeCycle { range: (to - from).abs(), count: 0.5, ends: [*start, *end] })
        }
        _ => None,
    });
    cycles.extend(halves);
    cycles.sort_by_key(|cycle| cycle.ends[1]);
    cycles
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(history: &[f64], range: f64) -> f64 {
        count(history).iter().filter(|c| (c.range - range).abs() < 1e-12).map(|c| c.count).sum()
    }

    #[test]
    fn the_worked_example_of_the_standard_is_reproduced() {
        // Figure 6 of ASTM E1049-85: the history A to I and its counted ranges.
        let history = [-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0];
        for (range, expected) in [(3.0, 0.5), (4.0, 1.5), (6.0, 0.5), (8.0, 1.0), (9.0, 0.5)] {
            assert_eq!(counts(&history, range), expected, "{range}");
        }
        assert_eq!(count(&history).iter().map(|c| c.count).sum::<f64>(), 4.0);
    }

    #[test]
    fn the_cycles_of_a_nearly_periodic_history_have_nearly_the_same_sums() {
        // Maxima and minima alternate by a part in a thousand, so that the partners of the largest
        // ranges lie in other cycles.
        let cycle = |k: usize| {
            let slightly = 1.0 + 1e-3 * [0.0, 1.0, -1.0, 0.5][k % 4];
            [0.0, 5.0 * slightly, 1.0, 2.0, -3.0 * slightly, 0.5]
        };
        let history: Vec<f64> = (0..12).flat_map(cycle).collect();
        let boundaries: Vec<usize> = (0..=12).map(|k| 6 * k).collect();
        let ranges = count(&history);
        let sums = sums_per_cycle(&ranges, &boundaries, &|c| c.count * c.range.powi(3));
        let inside = &sums[1..11];
        let (low, high) = inside.iter().fold((f64::MAX, 0.0_f64), |(l, h), s| (l.min(*s), h.max(*s)));
        assert!(high / low < 1.02, "{sums:?}");
        let total: f64 = ranges.iter().map(|c| c.count * c.range.powi(3)).sum();
        assert!((sums.iter().sum::<f64>() / total - 1.0).abs() < 1e-12);
    }

    #[test]
    fn points_between_extremes_and_repeated_values_do_not_count() {
        let plain = [-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0];
        let dense: Vec<f64> =
            plain.windows(2).flat_map(|w| [w[0], w[0], 0.7 * w[0] + 0.3 * w[1]]).chain([-2.0]).collect();
        for range in [3.0, 4.0, 6.0, 8.0, 9.0] {
            assert_eq!(counts(&dense, range), counts(&plain, range), "{range}");
        }
        assert!(count(&[1.0, 1.0, 1.0]).is_empty() && count(&[]).is_empty());
    }

    #[test]
    fn the_range_sum_is_the_length_of_the_path() {
        // Every leg of the history belongs to one half of one cycle.
        let history: Vec<f64> =
            (0..400).map(|i| (1.7 * f64::from(i)).sin() + (0.1 * f64::from(i)).cos()).collect();
        let path: f64 = history.windows(2).map(|w| (w[1] - w[0]).abs()).sum();
        let counted: f64 = count(&history).iter().map(|c| 2.0 * c.count * c.range).sum();
        assert!((counted / path - 1.0).abs() < 1e-12, "{counted} {path}");
    }
}
