//! A sensor's reading is limited by an amplifier, a converter or a stop.
//!
//! `reading` is limited to `-1/inverse_limit` to `1/inverse_limit`, noise included. Parameter:
//! `inverse_limit`, the reciprocal in the unit of the channel, so that 0 is no limit (0 to 1e12,
//! prior 1e12, which is practically none). In a log: a flat top at the largest readings of one
//! channel. Confounded with a gain of the sensor if most readings are beyond the limit; a limit
//! that no reading reaches is invisible.

use super::kind::{Action, Apply, EffectKind, EffectParameter, Guess};
use crate::description::Plant;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "sensor-saturation",
    summary: "A sensor's reading is limited.",
    confounded_with: &["sensor-gain"],
    guess: Guess::LargestReading,
    actions: &[Action {
        plants: Plant::ALL,
        parameters: &[EffectParameter::size("inverse_limit", "1/channel", 1.0, [0.0, 1e12], 1e12)],
        apply: Apply::Sensor(|sensor, parameter| {
            sensor.inverse_limit = sensor.inverse_limit.max(parameter("inverse_limit"))
        }),
    }],
    ..EffectKind::DEFAULT
};
