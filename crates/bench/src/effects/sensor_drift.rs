//! A sensor's offset drifts.
//!
//! `reading = gain signal + offset + drift_per_s (t - t_start)`. Parameter: `drift_per_s` in the
//! unit of the channel per s (within 1e12). Scale and prior are multiples of the sensor's noise;
//! the prior is 1000 of it per s. In a log: one channel changes linearly with time, independently
//! of the motion. Confounded with an offset in a short log, and with drifting friction if the
//! motion has one direction.

use super::kind::{Action, Apply, EffectKind, EffectParameter};
use crate::description::Plant;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "sensor-drift",
    summary: "A sensor's offset drifts.",
    confounded_with: &["coulomb-asymmetry", "friction-step", "sensor-offset", "thermal-friction-drift"],
    actions: &[Action {
        plants: Plant::ALL,
        parameters: &[EffectParameter::size("drift_per_s", "channel/s", 1.0, [-1e12, 1e12], 1e3)],
        apply: Apply::Sensor(|sensor, parameter| sensor.drift_per_s += parameter("drift_per_s")),
    }],
    ..EffectKind::DEFAULT
};
