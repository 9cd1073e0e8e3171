//! A sensor has a constant offset.
//!
//! `reading = gain signal + offset`. Parameter: `offset` in the unit of the channel (within 1e12).
//! Scale and prior are multiples of the sensor's noise; the prior is 1000 of it. In a log: one
//! channel deviates by a constant, all others are right. Confounded with effects that shift that
//! one channel: asymmetric friction, play that never changes sides, a lever under constant load.

use super::kind::{Action, Apply, EffectKind, EffectParameter};
use crate::description::Plant;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "sensor-offset",
    summary: "A sensor has a constant offset.",
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
    actions: &[Action {
        plants: Plant::ALL,
        parameters: &[EffectParameter::size("offset", "channel", 1.0, [-1e12, 1e12], 1e3)],
        apply: Apply::Sensor(|sensor, parameter| sensor.offset += parameter("offset")),
    }],
    ..EffectKind::DEFAULT
};
