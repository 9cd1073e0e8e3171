//! Level and correlation of the noise on each channel.
//!
//! The level is the sensor's declared floor. If none is declared, or the log shows more, it is the
//! noise between repeated cycles ([`super::repeatability`]), or with fewer than three cycles the
//! noise in the residual's fourth differences, which respond to white noise and hardly to
//! structure.
//!
//! Once a model has been fitted, the noise is inflated by two factors: `excess`, the rms of the
//! residual over the floor, and `correlation_samples`, the integrated autocorrelation time, so that
//! `n/correlation_samples` of `n` samples count as independent. Both are 1 for a white residual at
//! the declared floor. They are taken from the best model at hand and not from the nominal one:
//! noise estimated on the nominal residual would hide slow effects completely.

use super::logs::{Columns, Data};
use super::repeatability::{Repeatability, repeatability};
use super::split::Use;
use super::tuning;
use crate::digits::four_digits;
use bench::signals::white_noise;
use bench::simulate::respond;
use bench::{Bench, Channel};
use std::collections::BTreeMap;

/// Origin of a noise floor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FloorSource {
    /// The description.
    Declared,
    /// Differences between repeated cycles.
    RepeatedCycles,
    /// Fourth differences of neighbouring samples.
    Differences,
    /// Noise of the input, which a simulated motion integrates.
    Input,
}

impl FloorSource {
    /// Name in JSON.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Declared => "declared",
            Self::RepeatedCycles => "repeats",
            Self::Differences => "differences",
            Self::Input => "input",
        }
    }
}

/// Noise of one channel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChannelNoise {
    /// White noise, one standard deviation; positive.
    pub(crate) floor: f64,
    pub(crate) source: FloorSource,
    /// Declared floor; 0 if none is declared.
    pub(crate) declared_floor: f64,
    /// Floor that the log itself shows.
    pub(crate) observed_floor: f64,
    pub(crate) observed_by: FloorSource,
    /// Rms of the residual over the floor, at least 1.
    pub(crate) excess: f64,
    /// Integrated autocorrelation time of the residual, samples; at least 1.
    pub(crate) correlation_samples: f64,
}

impl ChannelNoise {
    /// Returns whether the floor is the declared one.
    pub(crate) fn is_declared(&self) -> bool {
        self.source == FloorSource::Declared
    }

    /// Share of the variance in a fit that is the sensor's own noise: without excess, and
    /// correlated no longer than sensor noise is.
    pub(crate) fn sensor_share(&self) -> f64 {
        self.correlation_samples.min(tuning::MAX_SENSOR_CORRELATION_SAMPLES)
            / (self.correlation_samples * self.excess.powi(2))
    }

    /// Sentence about a declared floor that is far from the observed one; none if they agree.
    pub(crate) fn declaration_mismatch(&self, channel: Channel) -> Option<String> {
        let ratio = self.observed_floor / self.declared_floor;
        if self.declared_floor <= 0.0
            || self.source == FloorSource::Input
            || (tuning::MIN_OBSERVED_OVER_DECLARED..=tuning::MAX_OBSERVED_OVER_DECLARED).contains(&ratio)
        {
            return None;
        }
        let how = match self.observed_by {
            FloorSource::RepeatedCycles => "the difference between cycles",
            _ => "the difference of neighbouring samples",
        };
        Some(format!(
            "the noise of {channel} is declared as {} {unit}, but {how} shows {} {unit}",
            four_digits(self.declared_floor),
            four_digits(self.observed_floor),
            unit = channel.unit()
        ))
    }
}

/// Noise of every channel.
#[derive(Clone, Debug)]
pub(crate) struct NoiseModel(BTreeMap<Channel, ChannelNoise>);

impl NoiseModel {
    /// Floors from the description and from the residual of the nominal bench.
    pub(crate) fn from_nominal_residual(bench: &Bench, data: &Data, residual: &Columns) -> Self {
        let of_input = input_noise(bench, data);
        let floor_of = |&channel: &Channel| {
            let declared = bench.sensors().get(&channel).map_or(0.0, bench::signals::Sensor::floor);
            let white = white_deviation(data, residual, channel);
            let repeated = repeatability(data, residual, channel).map(|r: Repeatability| r.deviation);
            // Only white noise refutes a declaration: other noise between cycles may be the effect
            // that is searched for.
            let is_credible = declared > 0.0 && white <= tuning::MAX_WHITE_OVER_DECLARED * declared;
            let (floor, source) = match repeated {
                _ if is_credible => (declared, FloorSource::Declared),
                Some(deviation) => (deviation, FloorSource::RepeatedCycles),
                None => (white, FloorSource::Differences),
            };
            let by_input = of_input.get(&channel).copied().unwrap_or_default();
            let is_of_input = by_input > tuning::MIN_INPUT_SHARE * floor;
            let source = if is_of_input { FloorSource::Input } else { source };
            let floor = floor.hypot(by_input);
            let min = tuning::MIN_FLOOR_SHARE * largest_reading(data, channel).max(f64::MIN_POSITIVE);
            let noise = ChannelNoise {
                floor: floor.max(min),
                source,
                declared_floor: declared,
                observed_floor: repeated.unwrap_or(white),
                observed_by: if repeated.is_some() {
                    FloorSource::RepeatedCycles
                } else {
                    FloorSource::Differences
                },
                excess: 1.0,
                correlation_samples: 1.0,
            };
            (channel, noise)
        };
        Self(data.channels.iter().map(floor_of).collect())
    }

    /// The same floors with excess and correlation of a fitted model's residual.
    pub(crate) fn inflated(&self, data: &Data, residual: &Columns) -> Self {
        let inflate = |(&channel, noise): (&Channel, &ChannelNoise)| {
            let ResidualStatistics { rms, correlation_samples, count } =
                ResidualStatistics::new(data, residual, channel);
            let excess = rms / noise.floor;
            // An rms scatters by 1/sqrt(2 n). A correlation longer than that of sensor noise is
            // structure, and structure must not widen its own limit.
            let sensor_correlation = correlation_samples.min(tuning::MAX_SENSOR_CORRELATION_SAMPLES);
            let scatter = tuning::RMS_SIGMAS * (sensor_correlation / (2.0 * count.max(1.0))).sqrt();
            let excess = if excess > 1.0 + scatter { excess } else { 1.0 };
            (channel, ChannelNoise { excess, correlation_samples, ..*noise })
        };
        Self(self.0.iter().map(inflate).collect())
    }

    /// Noise of a channel; unit noise for a channel without samples.
    pub(crate) fn channel(&self, channel: Channel) -> ChannelNoise {
        let none = ChannelNoise {
            floor: 1.0,
            source: FloorSource::Differences,
            declared_floor: 0.0,
            observed_floor: 0.0,
            observed_by: FloorSource::Differences,
            excess: 1.0,
            correlation_samples: 1.0,
        };
        self.0.get(&channel).copied().unwrap_or(none)
    }

    /// Factor that scales a channel's residual so that its samples count as independent with unit
    /// variance.
    pub(crate) fn weight(&self, channel: Channel) -> f64 {
        let noise = self.channel(channel);
        1.0 / (noise.floor * noise.excess * noise.correlation_samples.sqrt())
    }

    /// Number of independent samples among the fitted ones.
    pub(crate) fn effective_samples(&self, data: &Data) -> f64 {
        let independent = |&c: &Channel| data.count(c, Use::Fit) as f64 / self.channel(c).correlation_samples;
        data.channels.iter().map(independent).sum()
    }

    /// Largest change of a channel's weight relative to another model, as a factor of at least 1.
    pub(crate) fn max_weight_change(&self, other: &Self) -> f64 {
        let ratio = |&c: &Channel| {
            let r = self.weight(c) / other.weight(c);
            r.max(1.0 / r)
        };
        self.0.keys().map(ratio).fold(1.0, f64::max)
    }

    /// Weighted fitted samples of columns, one block after the other.
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

/// Rms change of each channel by the noise of the input and of the start, where a motion is
/// simulated. Without feedback it adds up over time, beyond any sensor's noise.
fn input_noise(bench: &Bench, data: &Data) -> BTreeMap<Channel, f64> {
    let mut sums: BTreeMap<Channel, (f64, usize)> = BTreeMap::new();
    if bench.axis().is_none_or(|rig| rig.forward().is_none()) {
        return BTreeMap::new();
    }
    for log in &data.logs {
        let Ok(plain) = respond(bench, &log.inputs) else { continue };
        let disturbed = (0..tuning::INPUT_NOISES).filter_map(|seed| log.inputs.disturbed(seed));
        for response in disturbed.filter_map(|inputs| respond(bench, &inputs).ok()) {
            for (channel, values) in response {
                let Some(plain) = plain.get(&channel) else { continue };
                let (sum, count) = sums.entry(channel).or_default();
                let used = values.iter().zip(plain).zip(&log.uses).filter(|(_, used)| **used != Use::Skip);
                for ((there, here), _) in used {
                    *sum += (there - here).powi(2);
                    *count += 1;
                }
            }
        }
    }
    sums.into_iter().map(|(channel, (sum, count))| (channel, (sum / count.max(1) as f64).sqrt())).collect()
}

/// Largest magnitude of a channel's readings.
fn largest_reading(data: &Data, channel: Channel) -> f64 {
    let blocks = data.blocks.iter().filter(|b| b.channel == channel);
    blocks.flat_map(|b| &b.measured).fold(0.0, |m, v| f64::max(m, v.abs()))
}

/// Standard deviation of the white noise, from fourth differences of the residual over the samples
/// in use.
fn white_deviation(data: &Data, residual: &Columns, channel: Channel) -> f64 {
    let mut squares: Vec<f64> = Vec::new();
    for (block, values) in data.blocks.iter().zip(residual).filter(|(b, _)| b.channel == channel) {
        let (times, mut start) = (data.logs[block.log].inputs.time_s(), 0);
        for run in data.uses(block).chunk_by(|a, b| (*a == Use::Skip) == (*b == Use::Skip)) {
            let rows = start..start + run.len();
            start = rows.end;
            if let (Some(t), Some(v), false) =
                (times.get(rows.clone()), values.get(rows), run.first() == Some(&Use::Skip))
            {
                squares.extend(white_noise::squares(t, v));
            }
        }
    }
    white_noise::deviation(&mut squares)
}

/// Statistics of the fitted residual of a channel.
struct ResidualStatistics {
    rms: f64,
    /// Integrated autocorrelation time, samples; at least 1.
    correlation_samples: f64,
    /// Number of samples.
    count: f64,
}

impl ResidualStatistics {
    /// Pools the autocovariances of all runs of samples; the sum over lags ends at the first one
    /// within its own scatter.
    ///
    /// Held-out samples between fitted ones belong to a run, because fitted ones alone may be too
    /// short for a lag.
    fn new(data: &Data, residual: &Columns, channel: Channel) -> Self {
        let runs = runs_in_use(data, residual, channel);
        let count: usize = runs.iter().map(|run| run.len()).sum();
        let power: f64 = runs.iter().flat_map(|run| run.iter()).map(|v| v * v).sum();
        if count == 0 || power <= 0.0 {
            return Self { rms: 0.0, correlation_samples: 1.0, count: count as f64 };
        }
        let longest = runs.iter().map(|run| run.len()).max().unwrap_or_default();
        let mut correlation_samples = 1.0;
        for lag in 1..(longest as f64 * tuning::MAX_LAG_SHARE) as usize {
            let (mut sum, mut pairs) = (0.0, 0usize);
            for run in &runs {
                if let Some(later) = run.get(lag..) {
                    sum += run.iter().zip(later).map(|(a, b)| a * b).sum::<f64>();
                    pairs += later.len();
                }
            }
            if pairs == 0 {
                break;
            }
            let rho = sum / pairs as f64 / (power / count as f64);
            if rho < tuning::RHO_SIGMAS / (pairs as f64).sqrt() {
                break;
            }
            correlation_samples += 2.0 * rho;
        }
        Self { rms: (power / count as f64).sqrt(), correlation_samples, count: count as f64 }
    }
}

/// Runs of a channel's samples in use, up to the last fitted sample of each log.
fn runs_in_use<'a>(data: &Data, residual: &'a Columns, channel: Channel) -> Vec<&'a [f64]> {
    let mut runs: Vec<&[f64]> = Vec::new();
    for (block, values) in data.blocks.iter().zip(residual).filter(|(b, _)| b.channel == channel) {
        let uses = data.uses(block);
        let end = uses.iter().rposition(|u| *u == Use::Fit).map_or(0, |last| last + 1);
        let mut start = 0;
        for run in uses.get(..end).unwrap_or(uses).chunk_by(|a, b| (*a == Use::Skip) == (*b == Use::Skip)) {
            if run.first() != Some(&Use::Skip) {
                runs.extend(values.get(start..start + run.len()));
            }
            start += run.len();
        }
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::split::Split;
    use bench::simulate::record;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use statrs::distribution::{ContinuousCDF, Normal};

    #[test]
    fn skipped_samples_do_not_count_in_the_noise() {
        let bench = Bench::open("friction-rig").unwrap();
        let mut data = Data::new(&bench, &[record(&bench, 3).unwrap()], &[], Split::Halves).unwrap();
        let uses = &mut data.logs[0].uses;
        let used = uses.len() / 3;
        uses[used..].fill(Use::Skip);
        let mut draw = ChaCha8Rng::seed_from_u64(5);
        let normal = Normal::new(0.0, 1.0).unwrap();
        let mut value =
            |i: usize| normal.inverse_cdf(draw.random_range(1e-6..1.0)) * if i < used { 1.0 } else { 100.0 };
        let count = data.logs[0].uses.len();
        let residual: Columns = data.blocks.iter().map(|_| (0..count).map(&mut value).collect()).collect();
        let found = white_deviation(&data, &residual, data.channels[0]);
        assert!((found - 1.0).abs() < 0.2, "{found}");
    }
}
