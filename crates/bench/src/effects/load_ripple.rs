//! The load pulsates, and the load's sensor does not show it: a pump, a valve, a resonance beyond
//! the sensor's bandwidth.
//!
//! `F' = F + A cos(2 pi f t) + B sin(2 pi f t)` in the log's own time. Parameters: `cos_force_n`,
//! `sin_force_n` (within 1e6 N, prior 200 N; on an axis within 1e9 N, prior 3 times the load that
//! has the log's rms effort), shape `frequency_hz` (1e-3 to 1e4, default 10, prior 50). A
//! phenomenon, not a law. In a log: a line in the periodogram of bearing and drive force (bench) or
//! effort (an axis that carries its load), at a frequency that does not depend on the motion.
//! Confounded with a ripple over position at constant speed.

use super::kind::{Action, Apply, EffectKind, EffectParameter, Guess, Measure, Values};
use crate::description::{Plant, RippleTerm};
use crate::signals::Channel;

const FREQUENCY: EffectParameter =
    EffectParameter { scale: 0.01, ..EffectParameter::shape("frequency_hz", "Hz", 10.0, [1e-3, 1e4], 50.0) };

/// A component of the force on an axis.
const fn on_axis(name: &'static str) -> EffectParameter {
    EffectParameter::size(name, "N", 1e-3, [-1e9, 1e9], 3.0).in_log(Measure::Load)
}

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "load-ripple",
    summary: "The load pulsates, and the load's sensor does not show it.",
    shows_in: Some(Channel::BearingForceY),
    confounded_with: &["inertia-mismatch", "lever-ratio", "position-ripple"],
    guess: Guess::Frequency,
    actions: &[
        Action {
            plants: Plant::TRANSMISSION,
            parameters: &[
                EffectParameter::size("cos_force_n", "N", 10.0, [-1e6, 1e6], 200.0),
                EffectParameter::size("sin_force_n", "N", 10.0, [-1e6, 1e6], 200.0),
                FREQUENCY,
            ],
            apply: Apply::Transmission(|bench, parameter| bench.extension.load_ripples.push(term(parameter))),
        },
        Action {
            plants: Plant::AXES,
            parameters: &[on_axis("cos_force_n"), on_axis("sin_force_n"), FREQUENCY],
            apply: Apply::Axis(|rig, parameter| rig.extension.load_ripples.push(term(parameter))),
        },
    ],
    ..EffectKind::DEFAULT
};

fn term(parameter: &Values<'_>) -> RippleTerm {
    RippleTerm {
        cos: parameter("cos_force_n"),
        sin: parameter("sin_force_n"),
        per_unit: parameter("frequency_hz"),
    }
}
