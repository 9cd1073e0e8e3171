//! Noise of each channel as the result reports it.

use crate::data::logs::{Columns, Data};
use crate::data::noise::NoiseModel;
use crate::data::repeatability::repeatability;
use bench::Channel;
use schemars::JsonSchema;
use serde::Serialize;

/// Noise of one channel.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Noise {
    /// Channel.
    pub channel: Channel,
    /// White noise, one standard deviation.
    pub floor: f64,
    /// True if the floor is the declared one; otherwise it comes from the log.
    pub declared: bool,
    /// Origin of the floor: `declared`, `repeats` (differences between repeated cycles) or
    /// `differences` (of neighbouring samples).
    pub source: &'static str,
    /// Floor that the description declares.
    pub declared_floor: Option<f64>,
    /// Floor that the log shows: from repeats if the log has three cycles, else from differences.
    pub measured_floor: f64,
    /// Complete cycles compared; 0 if there are fewer than three.
    pub repeats: usize,
    /// Share of the nominal bench's residual power that repeats: model error, not noise.
    pub repeatable_share: Option<f64>,
    /// A sentence, if the declared floor is far from the measured one.
    pub finding: Option<String>,
    /// Rms of the last residual over the floor, at least 1.
    pub excess: f64,
    /// Integrated autocorrelation time of the residual, samples; so many samples count as one
    /// independent one.
    pub correlation_samples: f64,
}

/// Noise of every channel, given the residual `before` the extension.
pub(crate) fn noise_summary(data: &Data, noise: &NoiseModel, before: &Columns) -> Vec<Noise> {
    let noise_of = |&channel: &Channel| {
        let n = noise.channel(channel);
        let repeated = repeatability(data, before, channel);
        Noise {
            channel,
            floor: n.floor,
            declared: n.is_declared(),
            source: n.source.name(),
            declared_floor: (n.declared_floor > 0.0).then_some(n.declared_floor),
            measured_floor: n.observed_floor,
            repeats: repeated.map_or(0, |r| r.cycles),
            repeatable_share: repeated.map(|r| r.repeatable_share),
            finding: n.declaration_mismatch(channel),
            excess: n.excess,
            correlation_samples: n.correlation_samples,
        }
    };
    data.channels.iter().map(noise_of).collect()
}
