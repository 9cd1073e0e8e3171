//! A sensor's factor is off.
//!
//! `reading = gain (1 + relative_change) signal + offset`. Parameter: `relative_change`, -0.99 to 0.99, prior 0.1.
//! In a log: one channel is off in proportion to itself.
//! Confounded with what scales that channel alone: the friction level (torque), inertia (force), stiffness (journal).

use super::kind::{EffectKind, EffectParameter, Guess, Plant};
use super::sensor;

const SIZE: &[EffectParameter] = &[EffectParameter::size("relative_change", "1", 0.01, [-0.99, 0.99], 0.1)];

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "sensor-gain",
    summary: "A sensor's factor is off.",
    per_channel: true,
    plants: Plant::ALL,
    transmission: SIZE,
    axis: SIZE,
    shows_in: None,
    confounded_with: &[
        "clearance-wear",
        "contact-stiffness",
        "coulomb-level",
        "inertia-mismatch",
        "journal-out-of-round",
        "lever-ratio",
        "sensor-saturation",
        "viscous-friction",
    ],
    guess: Guess::Defaults,
    apply: |bench, channel, parameter| {
        if let Some(sensor) = sensor(bench, channel) {
            sensor.gain *= 1.0 + parameter("relative_change");
        }
    },
};
