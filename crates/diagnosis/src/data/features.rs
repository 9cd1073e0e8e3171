//! Quantities that a residual may depend on, and its mean over bins of them.

use super::logs::{Columns, Data, Log};
use super::split::Use;
use super::tuning;
use bench::Channel;
use bench::statistics::mean;

/// Quantity that a residual may depend on.
pub(crate) struct Feature {
    /// Name in JSON and in sentences.
    pub(crate) name: &'static str,
    /// Number of bins.
    pub(crate) bins: usize,
    /// Value at a sample of a log; `None` if the log has no such quantity.
    pub(crate) read: fn(&Log, usize) -> Option<f64>,
}

/// Features, simple ones first.
pub(crate) const FEATURES: &[Feature] = &[
    Feature { name: "direction", bins: 2, read: |log, i| Some(direction(log.speed[i])) },
    Feature { name: "load", bins: tuning::LOAD_BINS, read: |log, i| Some(log.load[i]) },
    Feature {
        name: "load times direction",
        bins: tuning::MOTION_BINS,
        read: |log, i| Some(log.load[i] * direction(log.speed[i])),
    },
    Feature { name: "speed", bins: tuning::MOTION_BINS, read: |log, i| Some(log.speed[i]) },
    Feature { name: "position", bins: tuning::MOTION_BINS, read: |log, i| Some(log.position[i]) },
    Feature { name: "time", bins: tuning::TIME_BINS, read: |log, i| log.inputs.time_s().get(i).copied() },
    Feature {
        name: "cycle phase",
        bins: tuning::PHASE_BINS,
        read: |log, i| log.phase.as_ref().map(|p| p[i].rem_euclid(1.0)),
    },
];

/// Sign of a speed: 1 forward, -1 backward, 0 at standstill.
fn direction(speed: f64) -> f64 {
    if speed == 0.0 { 0.0 } else { speed.signum() }
}

/// A range of a feature and the residual in it.
pub(crate) struct Bin {
    /// Smallest value of the feature.
    pub(crate) from: f64,
    /// Largest value of the feature.
    pub(crate) to: f64,
    /// Mean residual.
    pub(crate) mean: f64,
    /// Number of samples.
    pub(crate) count: f64,
}

/// Mean square of the residual that the means of bins explain.
pub(crate) fn explained_power(bins: &[Bin]) -> f64 {
    let count: f64 = bins.iter().map(|b| b.count).sum();
    bins.iter().map(|b| b.count * b.mean * b.mean).sum::<f64>() / count
}

/// Bins of equal counts, so that no bin consists of a few outliers; `None` for a constant feature.
/// Equal values, such as every speed at standstill, share a bin.
pub(crate) fn bins(data: &Data, residual: &Columns, channel: Channel, feature: &Feature) -> Option<Vec<Bin>> {
    let mut points: Vec<(f64, f64)> = Vec::new();
    for (block, values) in data.blocks.iter().zip(residual).filter(|(b, _)| b.channel == channel) {
        let log = &data.logs[block.log];
        for (i, value) in values.iter().enumerate().filter(|(i, _)| log.uses[*i] != Use::Skip) {
            points.push(((feature.read)(log, i)?, *value));
        }
    }
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (first, last) = (points.first()?.0, points.last()?.0);
    if last - first <= tuning::MIN_FEATURE_SPAN * last.abs().max(first.abs()) {
        return None;
    }
    let size = if feature.name == "direction" { 1 } else { points.len().div_ceil(feature.bins) };
    let groups = groups(&points, size);
    let bin = |group: &&[(f64, f64)]| Bin {
        from: group.first().map_or(0.0, |p| p.0),
        to: group.last().map_or(0.0, |p| p.0),
        mean: mean(group.iter().map(|p| p.1)),
        count: group.len() as f64,
    };
    Some(groups.iter().map(bin).collect())
}

/// Splits ascending points into groups of `size` or more; equal neighbours stay together.
fn groups(points: &[(f64, f64)], size: usize) -> Vec<&[(f64, f64)]> {
    let mut groups: Vec<&[(f64, f64)]> = Vec::new();
    let (mut from, mut to) = (0, 0);
    for equal in points.chunk_by(|a, b| a.0 == b.0) {
        to += equal.len();
        if to - from >= size || to == points.len() {
            groups.extend(points.get(from..to));
            from = to;
        }
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_values_share_a_bin() {
        let points = |at: &[f64]| -> Vec<(f64, f64)> { at.iter().map(|x| (*x, 1.0)).collect() };
        let sizes =
            |at: &[f64], size| -> Vec<usize> { groups(&points(at), size).iter().map(|g| g.len()).collect() };
        assert_eq!(sizes(&[1.0, 2.0, 3.0, 4.0, 5.0], 2), [2, 2, 1]);
        assert_eq!(sizes(&[-1.0, 0.0, 0.0, 0.0, 0.0, 2.0], 2), [5, 1]);
        assert_eq!(sizes(&[-1.0, -1.0, 0.0, 1.0], 1), [2, 1, 1]);
    }

    #[test]
    fn standstill_has_no_direction() {
        assert_eq!([2.0, -0.1, 0.0].map(direction), [1.0, -1.0, 0.0]);
    }
}
