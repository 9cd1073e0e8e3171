//! Level and correlation of the noise on each channel.
//!
//! The level is the sensor's declared floor, or, where none is declared or the log shows more, what repeated cycles show
//! ([`crate::repeats`]), or in a log of fewer than three what the residual's fourth differences show (they see white noise
//! and hardly any structure). Two inflations follow once a model has been
//! fitted: `excess`, the rms of its residual over the floor, and `correlation`, the integrated autocorrelation time in
//! samples, so that `n/correlation` samples count as independent. A residual that is white at the declared floor has
//! both at 1. They are taken from the best model at hand, not from the nominal one: noise that is fitted on the suspect
//! residual eats slow effects completely.

use crate::digits::four_digits;
use crate::repeats::{Repeats, repeats};
use crate::session::{Columns, Data, Use};
use bench::{Bench, Channel, white_noise};
use std::collections::BTreeMap;

/// Observed over declared noise from which the declaration is not believed.
const DISBELIEF: f64 = 1.15;
/// Noise of a log over its declaration between which the declaration stands.
const LEAST_RATIO: f64 = 0.5;
const MOST_RATIO: f64 = 1.5;
/// Longest correlation of a sensor's own noise, samples.
const LONGEST_CORRELATION: f64 = 16.0;
/// Most lags of the autocorrelation, as a share of a stretch.
const LAG_SHARE: f64 = 0.25;

/// Where a floor comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Source {
    /// The description.
    Declared,
    /// What does not repeat from cycle to cycle.
    Repeats,
    /// Fourth differences.
    Differences,
}

impl Source {
    /// The word in JSON.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Declared => "declared",
            Self::Repeats => "repeats",
            Self::Differences => "differences",
        }
    }
}

/// Noise of one channel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChannelNoise {
    /// White noise, one standard deviation; above 0.
    pub(crate) floor: f64,
    pub(crate) declared: bool,
    pub(crate) source: Source,
    /// What the description says; 0 where it says nothing.
    pub(crate) stated: f64,
    /// What the log itself shows, and how.
    pub(crate) seen: f64,
    pub(crate) seen_by: Source,
    /// Rms over the floor, 1 or more.
    pub(crate) excess: f64,
    /// Samples that count as one, 1 or more.
    pub(crate) correlation: f64,
}

impl ChannelNoise {
    /// Share of the variance that the sensor's own noise makes of what the fit counts with: no excess, and correlated no longer
    /// than a sensor's noise is.
    pub(crate) fn own_share(&self) -> f64 {
        self.correlation.min(LONGEST_CORRELATION) / (self.correlation * self.excess.powi(2))
    }

    /// In words, where the declaration is far from what the log shows.
    pub(crate) fn finding(&self, channel: Channel) -> Option<String> {
        let ratio = self.seen / self.stated;
        if self.stated <= 0.0 || (LEAST_RATIO..=MOST_RATIO).contains(&ratio) {
            return None;
        }
        let how = match self.seen_by {
            Source::Repeats => "what does not repeat from cycle to cycle",
            _ => "what neighbouring samples show",
        };
        Some(format!(
            "noise of {channel} is declared as {} {unit}; {how} is {} {unit}",
            four_digits(self.stated),
            four_digits(self.seen),
            unit = channel.unit()
        ))
    }
}

/// Noise of every channel.
#[derive(Clone, Debug)]
pub(crate) struct NoiseModel(BTreeMap<Channel, ChannelNoise>);

impl NoiseModel {
    /// Floors from the description and the residual of the nominal bench.
    pub(crate) fn floors(bench: &Bench, data: &Data, residual: &Columns) -> Self {
        let of = |&channel: &Channel| {
            let declared = bench.sensors().get(&channel).map_or(0.0, bench::sensor::Sensor::floor);
            let white = differences(data, residual, channel);
            let repeated = repeats(data, residual, channel).map(|r: Repeats| r.deviation);
            // Only white noise speaks against a declaration: what else does not repeat may be the effect that is sought.
            let believed = declared > 0.0 && white <= DISBELIEF * declared;
            let (floor, source) = match repeated {
                _ if believed => (declared, Source::Declared),
                Some(deviation) => (deviation, Source::Repeats),
                None => (white, Source::Differences),
            };
            let least = 1e-9 * size(data, channel).max(f64::MIN_POSITIVE);
            let noise = ChannelNoise {
                floor: floor.max(least),
                declared: believed,
                source,
                stated: declared,
                seen: repeated.unwrap_or(white),
                seen_by: if repeated.is_some() { Source::Repeats } else { Source::Differences },
                excess: 1.0,
                correlation: 1.0,
            };
            (channel, noise)
        };
        Self(data.channels.iter().map(of).collect())
    }

    /// The same floors with excess and correlation of a fitted model's residual.
    pub(crate) fn inflated(&self, data: &Data, residual: &Columns) -> Self {
        let of = |(&channel, noise): (&Channel, &ChannelNoise)| {
            let (rms, correlation, count) = correlation(data, residual, channel);
            let excess = rms / noise.floor;
            // An rms scatters by 1/sqrt(2 n): less than three of that is no excess. What is correlated longer than a sensor's noise is structure,
            // and structure must not excuse itself.
            let of_noise = correlation.min(LONGEST_CORRELATION);
            let scatter = 3.0 * (of_noise / (2.0 * count.max(1.0))).sqrt();
            let excess = if excess > 1.0 + scatter { excess } else { 1.0 };
            (channel, ChannelNoise { excess, correlation, ..*noise })
        };
        Self(self.0.iter().map(of).collect())
    }

    /// Noise of a channel.
    pub(crate) fn of(&self, channel: Channel) -> ChannelNoise {
        let none = ChannelNoise {
            floor: 1.0,
            declared: false,
            source: Source::Differences,
            stated: 0.0,
            seen: 0.0,
            seen_by: Source::Differences,
            excess: 1.0,
            correlation: 1.0,
        };
        self.0.get(&channel).copied().unwrap_or(none)
    }

    /// Factor that makes a residual of a channel count as independent samples of unit variance.
    pub(crate) fn weight(&self, channel: Channel) -> f64 {
        let n = self.of(channel);
        1.0 / (n.floor * n.excess * n.correlation.sqrt())
    }

    /// Independent samples among the fitted ones.
    pub(crate) fn effective_samples(&self, data: &Data) -> f64 {
        data.channels.iter().map(|&c| data.count(c, Use::Fit) as f64 / self.of(c).correlation).sum()
    }

    /// Largest change of a channel's weight against another model, as a factor of 1 or more.
    pub(crate) fn change(&self, other: &Self) -> f64 {
        let ratio = |&c: &Channel| {
            let r = self.weight(c) / other.weight(c);
            r.max(1.0 / r)
        };
        self.0.keys().map(ratio).fold(1.0, f64::max)
    }

    /// Stacks the fitted samples of columns, weighted.
    pub(crate) fn stack(&self, data: &Data, columns: &Columns) -> Vec<f64> {
        let mut out = Vec::new();
        for (block, values) in data.blocks.iter().zip(columns) {
            let weight = self.weight(block.channel);
            let fitted = values.iter().zip(data.uses(block)).filter(|(_, u)| **u == Use::Fit);
            out.extend(fitted.map(|(v, _)| weight * v));
        }
        out
    }
}

fn size(data: &Data, channel: Channel) -> f64 {
    let blocks = data.blocks.iter().filter(|b| b.channel == channel);
    blocks.flat_map(|b| &b.measured).fold(0.0, |m, v| f64::max(m, v.abs()))
}

/// White noise by what a residual has beyond cubics, over the samples that are used.
fn differences(data: &Data, residual: &Columns, channel: Channel) -> f64 {
    let mut squares: Vec<f64> = Vec::new();
    for (block, values) in data.blocks.iter().zip(residual).filter(|(b, _)| b.channel == channel) {
        let (times, mut start) = (data.sessions[block.session].inputs.time_s(), 0);
        for run in data.uses(block).chunk_by(|a, b| (*a == Use::Skip) == (*b == Use::Skip)) {
            let stretch = start..start + run.len();
            start = stretch.end;
            if let (Some(t), Some(v), false) =
                (times.get(stretch.clone()), values.get(stretch), run.first() == Some(&Use::Skip))
            {
                squares.extend(white_noise::squares(t, v));
            }
        }
    }
    white_noise::deviation(&mut squares)
}

/// Rms, integrated autocorrelation time and count of the fitted residual of a channel.
///
/// Autocovariances of all stretches are pooled; the sum ends at the first one that is lost in its own scatter. Held-out samples
/// between fitted ones belong to a stretch: the fitted ones alone may be too short for a lag.
fn correlation(data: &Data, residual: &Columns, channel: Channel) -> (f64, f64, f64) {
    let mut stretches: Vec<&[f64]> = Vec::new();
    for (block, values) in data.blocks.iter().zip(residual).filter(|(b, _)| b.channel == channel) {
        let uses = data.uses(block);
        let end = uses.iter().rposition(|u| *u == Use::Fit).map_or(0, |last| last + 1);
        let mut start = 0;
        for run in uses.get(..end).unwrap_or(uses).chunk_by(|a, b| (*a == Use::Skip) == (*b == Use::Skip)) {
            if run.first() != Some(&Use::Skip) {
                stretches.extend(values.get(start..start + run.len()));
            }
            start += run.len();
        }
    }
    let count: usize = stretches.iter().map(|s| s.len()).sum();
    let power: f64 = stretches.iter().flat_map(|s| s.iter()).map(|v| v * v).sum();
    if count == 0 || power <= 0.0 {
        return (0.0, 1.0, count as f64);
    }
    let longest = stretches.iter().map(|s| s.len()).max().unwrap_or_default();
    let mut time = 1.0;
    for lag in 1..(longest as f64 * LAG_SHARE) as usize {
        let (mut sum, mut pairs) = (0.0, 0usize);
        for s in &stretches {
            if let Some(later) = s.get(lag..) {
                sum += s.iter().zip(later).map(|(a, b)| a * b).sum::<f64>();
                pairs += later.len();
            }
        }
        if pairs == 0 {
            break;
        }
        let rho = sum / pairs as f64 / (power / count as f64);
        if rho < 2.5 / (pairs as f64).sqrt() {
            break;
        }
        time += 2.0 * rho;
    }
    ((power / count as f64).sqrt(), time, count as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::Split;
    use bench::record::record;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use statrs::distribution::{ContinuousCDF, Normal};

    #[test]
    fn what_is_left_out_of_a_diagnosis_has_no_part_in_its_noise() {
        let bench = Bench::open("friction-rig").unwrap();
        let mut data = Data::new(&bench, &[record(&bench, 3).unwrap()], &[], Split::Halves).unwrap();
        let uses = &mut data.sessions[0].uses;
        let used = uses.len() / 3;
        uses[used..].fill(Use::Skip);
        let mut draw = ChaCha8Rng::seed_from_u64(5);
        let normal = Normal::new(0.0, 1.0).unwrap();
        let mut value =
            |i: usize| normal.inverse_cdf(draw.random_range(1e-6..1.0)) * if i < used { 1.0 } else { 100.0 };
        let count = data.sessions[0].uses.len();
        let residual: Columns = data.blocks.iter().map(|_| (0..count).map(&mut value).collect()).collect();
        let found = differences(&data, &residual, data.channels[0]);
        assert!((found - 1.0).abs() < 0.2, "{found}");
    }
}
