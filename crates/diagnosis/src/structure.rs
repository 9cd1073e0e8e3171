//! Where structure sits: the quantity over whose bins the residual's mean varies most.

use crate::digits::{four_digits, stretch};
use crate::session::{Columns, Data, Session, Use};
use bench::Channel;

/// Share of the best quantity's explained power at which a plainer one is preferred.
const PLAINER: f64 = 0.85;

pub(crate) struct Feature {
    pub(crate) name: &'static str,
    pub(crate) bins: usize,
    pub(crate) read: fn(&Session, usize) -> Option<f64>,
}

/// Plain ones first.
pub(crate) const FEATURES: &[Feature] = &[
    Feature { name: "direction", bins: 2, read: |s, i| Some(direction(s.speed[i])) },
    Feature { name: "load", bins: 4, read: |s, i| Some(s.load[i]) },
    Feature { name: "load times direction", bins: 8, read: |s, i| Some(s.load[i] * direction(s.speed[i])) },
    Feature { name: "speed", bins: 8, read: |s, i| Some(s.speed[i]) },
    Feature { name: "position", bins: 8, read: |s, i| Some(s.position[i]) },
    Feature { name: "time", bins: 12, read: |s, i| s.inputs.time_s().get(i).copied() },
    Feature { name: "cycle phase", bins: 24, read: |s, i| s.phase.as_ref().map(|p| p[i].rem_euclid(1.0)) },
];

/// 1 forward, -1 backward, 0 at rest.
fn direction(speed: f64) -> f64 {
    if speed == 0.0 { 0.0 } else { speed.signum() }
}

/// The quantity's name, and in words where the residual of a channel is largest.
pub(crate) fn describe(data: &Data, residual: &Columns, channel: Channel) -> (&'static str, String) {
    let binned: Vec<(&Feature, Vec<Bin>, f64)> = FEATURES
        .iter()
        .filter_map(|feature| {
            let bins = bins(data, residual, channel, feature)?;
            let total: f64 = bins.iter().map(|b| b.count).sum();
            let explained = bins.iter().map(|b| b.count * b.mean * b.mean).sum::<f64>() / total;
            Some((feature, bins, explained))
        })
        .collect();
    let most = binned.iter().map(|b| b.2).fold(0.0, f64::max);
    let Some((feature, bins, _)) = binned.iter().find(|b| b.2 >= PLAINER * most) else {
        return ("none", "nowhere in particular".into());
    };
    let low = bins.iter().min_by(|a, b| a.mean.total_cmp(&b.mean));
    let high = bins.iter().max_by(|a, b| a.mean.total_cmp(&b.mean));
    let unit = channel.unit();
    let words = match (low, high) {
        (Some(low), Some(high)) => format!(
            "varies with {}: mean residual {} {unit} at {} and {} {unit} at {}",
            feature.name,
            four_digits(high.mean),
            high.words(feature.name),
            four_digits(low.mean),
            low.words(feature.name),
        ),
        _ => String::new(),
    };
    (feature.name, words)
}

pub(crate) struct Bin {
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) mean: f64,
    pub(crate) count: f64,
}

impl Bin {
    fn words(&self, feature: &str) -> String {
        match feature {
            "direction" if self.to > 0.0 => "forward motion".into(),
            "direction" if self.to < 0.0 => "backward motion".into(),
            "direction" | "speed" if self.from == 0.0 && self.to == 0.0 => "rest".into(),
            _ => stretch(self.from, self.to),
        }
    }
}

/// Bins of equal counts, so that no bin is a few outliers; what is equal, as every speed at rest, is in one bin.
pub(crate) fn bins(data: &Data, residual: &Columns, channel: Channel, feature: &Feature) -> Option<Vec<Bin>> {
    let mut points: Vec<(f64, f64)> = Vec::new();
    for (block, values) in data.blocks.iter().zip(residual).filter(|(b, _)| b.channel == channel) {
        let session = &data.sessions[block.session];
        for (i, value) in values.iter().enumerate().filter(|(i, _)| session.uses[*i] != Use::Skip) {
            points.push(((feature.read)(session, i)?, *value));
        }
    }
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (first, last) = (points.first()?.0, points.last()?.0);
    if last - first <= 1e-3 * last.abs().max(first.abs()) {
        return None;
    }
    let size = if feature.name == "direction" { 1 } else { points.len().div_ceil(feature.bins) };
    let groups = groups(&points, size);
    let bin = |group: &&[(f64, f64)]| Bin {
        from: group.first().map_or(0.0, |p| p.0),
        to: group.last().map_or(0.0, |p| p.0),
        mean: group.iter().map(|p| p.1).sum::<f64>() / group.len().max(1) as f64,
        count: group.len() as f64,
    };
    Some(groups.iter().map(bin).collect())
}

/// Ascending points in groups of a size or, where neighbours are equal, more.
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
    fn what_is_equal_is_in_one_bin() {
        let points = |at: &[f64]| -> Vec<(f64, f64)> { at.iter().map(|x| (*x, 1.0)).collect() };
        let sizes =
            |at: &[f64], size| -> Vec<usize> { groups(&points(at), size).iter().map(|g| g.len()).collect() };
        assert_eq!(sizes(&[1.0, 2.0, 3.0, 4.0, 5.0], 2), [2, 2, 1]);
        assert_eq!(sizes(&[-1.0, 0.0, 0.0, 0.0, 0.0, 2.0], 2), [5, 1]);
        assert_eq!(sizes(&[-1.0, -1.0, 0.0, 1.0], 1), [2, 1, 1]);
    }

    #[test]
    fn a_rest_has_no_direction() {
        assert_eq!([2.0, -0.1, 0.0].map(direction), [1.0, -1.0, 0.0]);
        let bin = |from, to| Bin { from, to, mean: 1.0, count: 1.0 };
        assert_eq!(bin(0.0, 0.0).words("direction"), "rest");
        assert_eq!(bin(-1.0, -1.0).words("direction"), "backward motion");
        assert_eq!(bin(0.0, 0.0).words("speed"), "rest");
        assert_eq!(bin(0.0, 0.2).words("speed"), "0 to 0.2000");
        assert_eq!(bin(0.0, 0.0).words("load"), "0");
    }
}
