//! A sensor is delayed.
//!
//! `reading(t) = signal(t - delay_s)`. Parameter: `delay_s`, -0.5 to 0.5 s (negative: the others
//! are delayed), prior 10 ms. In a log: one channel deviates in proportion to its own rate.
//! Confounded with a lag of the drive, and under sinusoidal motion with viscous friction or
//! inertia.

use super::kind::{Action, Apply, EffectKind, EffectParameter};
use crate::description::Plant;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "sensor-delay",
    summary: "A sensor is delayed.",
    confounded_with: &["drive-lag", "inertia-mismatch", "presliding-hysteresis", "viscous-friction"],
    actions: &[Action {
        plants: Plant::ALL,
        parameters: &[EffectParameter::size("delay_s", "s", 2e-4, [-0.5, 0.5], 0.01)],
        apply: Apply::Sensor(|sensor, parameter| sensor.delay_s += parameter("delay_s")),
    }],
    ..EffectKind::DEFAULT
};
