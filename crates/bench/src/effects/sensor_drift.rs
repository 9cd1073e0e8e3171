//! A sensor's offset drifts.
//!
//! `reading = gain signal + offset + drift_per_s (t - t_start)`. Parameter: `drift_per_s` in the unit of the channel per s (within 1e12); scale
//! and prior count in the sensor's own noise, prior 1000 of it per s.
//! In a log: one channel moves away at a steady pace whatever the bench does.
//! Confounded with an offset in a short log, and with friction that drifts where the motion is one way.

use super::kind::{EffectKind, EffectParameter, Guess, Plant};
use super::sensor;

const SIZE: &[EffectParameter] =
    &[EffectParameter::size("drift_per_s", "channel/s", 1.0, [-1e12, 1e12], 1e3)];

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "sensor-drift",
    summary: "A sensor's offset drifts.",
    per_channel: true,
    plants: Plant::ALL,
    transmission: SIZE,
    axis: SIZE,
    shows_in: None,
    confounded_with: &["coulomb-asymmetry", "friction-step", "sensor-offset", "thermal-friction-drift"],
    guess: Guess::Defaults,
    apply: |bench, channel, parameter| {
        if let Some(sensor) = sensor(bench, channel) {
            sensor.drift_per_s += parameter("drift_per_s");
        }
    },
};
