//! Range, resolution and noise of each channel of checked logs.

use crate::check::step;
use crate::data::noise::NoiseModel;
use crate::statistics::limits;
use bench::signals::white_noise;
use bench::{Bench, Channel, MeasuredLog, Role};
use schemars::JsonSchema;
use serde::Serialize;

/// Quality of one channel over all logs.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ChannelQuality {
    /// Channel.
    pub channel: Channel,
    /// `input` or `output`.
    pub role: &'static str,
    /// Unit of all values.
    pub unit: &'static str,
    /// Smallest reading.
    pub min: f64,
    /// Largest reading.
    pub max: f64,
    /// Step of the readings; none if they are continuous.
    pub resolution: Option<f64>,
    /// Noise: of an output as an evaluation uses it, of an input from neighbouring samples.
    pub noise: f64,
    /// Origin of the noise: `declared`, `repeats`, `differences` or `input`.
    pub noise_source: &'static str,
    /// White noise between neighbouring samples.
    pub white_noise: f64,
    /// Noise and resolution that the description declares; none if it declares nothing.
    pub declared_noise: Option<f64>,
}

/// Qualities of all channels of the logs.
pub(super) fn channel_qualities(
    bench: &Bench,
    logs: &[MeasuredLog],
    noise: &NoiseModel,
) -> Vec<ChannelQuality> {
    let has = |channel: &&Channel| logs.iter().any(|log| log.channels.contains_key(channel));
    let quality = |&channel: &Channel| {
        let readings = || logs.iter().filter_map(|log| Some((&log.time_s, log.channels.get(&channel)?)));
        let (min, max) = limits(readings().flat_map(|(_, values)| values.iter().copied()));
        let mut squares: Vec<f64> =
            readings().flat_map(|(time_s, values)| white_noise::squares(time_s, values)).collect();
        let white = white_noise::deviation(&mut squares);
        let is_compared = bench.role(channel) == Role::Output && bench.simulates(channel);
        let floor = noise.channel(channel);
        let declared = bench.sensors().get(&channel).map_or(0.0, bench::signals::Sensor::floor);
        ChannelQuality {
            channel,
            role: if bench.role(channel) == Role::Input { "input" } else { "output" },
            unit: channel.unit(),
            min,
            max,
            resolution: readings().filter_map(|(_, values)| step(values)).reduce(f64::min),
            noise: if is_compared { floor.floor } else { white },
            noise_source: if is_compared { floor.source.name() } else { "differences" },
            white_noise: white,
            declared_noise: (declared > 0.0).then_some(declared),
        }
    };
    Channel::ALL.iter().filter(has).map(quality).collect()
}
