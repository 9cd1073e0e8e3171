//! A sensor's reading ends at a limit: amplifier, converter or stop.
//!
//! `reading` is held within `-1/inverse_limit` to `1/inverse_limit`, noise included. Parameter: `inverse_limit` in 1 over the unit of the
//! channel, so that 0 is no limit (0 to 1e12, no prior worth the name: 1e12).
//! In a log: a flat top at the largest readings of one channel.
//! Confounded with a factor of the sensor where most readings are beyond the limit; a limit that no reading reaches is invisible.

use super::kind::{EffectKind, EffectParameter, Guess, Plant};
use super::sensor;

const SIZE: &[EffectParameter] =
    &[EffectParameter::size("inverse_limit", "1/channel", 1.0, [0.0, 1e12], 1e12)];

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "sensor-saturation",
    summary: "A sensor's reading ends at a limit.",
    per_channel: true,
    plants: Plant::ALL,
    transmission: SIZE,
    axis: SIZE,
    shows_in: None,
    confounded_with: &["sensor-gain"],
    guess: Guess::LargestReading,
    apply: |bench, channel, parameter| {
        if let Some(sensor) = sensor(bench, channel) {
            sensor.inverse_limit = sensor.inverse_limit.max(parameter("inverse_limit"));
        }
    },
};
