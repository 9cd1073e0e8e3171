//! A sensor is late.
//!
//! `reading(t) = signal(t - delay_s)`. Parameter: `delay_s`, -0.5 to 0.5 s (negative: the others are late), prior 10 ms.
//! In a log: one channel deviates in proportion to its own rate.
//! Confounded with a lag of the drive, and on a sine with viscous friction or inertia.

use super::kind::{EffectKind, EffectParameter, Guess, Plant};
use super::sensor;

const SIZE: &[EffectParameter] = &[EffectParameter::size("delay_s", "s", 2e-4, [-0.5, 0.5], 0.01)];

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "sensor-delay",
    summary: "A sensor is late.",
    per_channel: true,
    plants: Plant::ALL,
    transmission: SIZE,
    axis: SIZE,
    shows_in: None,
    confounded_with: &["drive-lag", "inertia-mismatch", "presliding-hysteresis", "viscous-friction"],
    guess: Guess::Defaults,
    apply: |bench, channel, parameter| {
        if let Some(sensor) = sensor(bench, channel) {
            sensor.delay_s += parameter("delay_s");
        }
    },
};
