//! A sensor reads a constant too much.
//!
//! `reading = gain signal + offset`. Parameter: `offset` in the unit of the channel (within 1e12); scale and prior count in the
//! sensor's own noise, prior 1000 of it.
//! In a log: one channel is off by a constant, everything else is right.
//! Confounded with whatever shifts that one channel: asymmetric friction, play that never changes sides, a lever under constant load.

use super::kind::{EffectKind, EffectParameter, Guess, Plant};
use super::sensor;

const SIZE: &[EffectParameter] = &[EffectParameter::size("offset", "channel", 1.0, [-1e12, 1e12], 1e3)];

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "sensor-offset",
    summary: "A sensor reads a constant too much.",
    per_channel: true,
    plants: Plant::ALL,
    transmission: SIZE,
    axis: SIZE,
    shows_in: None,
    confounded_with: &[
        "clearance-wear",
        "coulomb-asymmetry",
        "fork-backlash",
        "hydraulic-compliance",
        "journal-out-of-round",
        "lever-ratio",
        "misalignment",
        "seal-friction",
        "sensor-drift",
        "viscous-asymmetry",
    ],
    guess: Guess::Defaults,
    apply: |bench, channel, parameter| {
        if let Some(sensor) = sensor(bench, channel) {
            sensor.offset += parameter("offset");
        }
    },
};
