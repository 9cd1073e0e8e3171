//! Dry friction changes at one time: lubricant arrives or is lost, a surface is scored, a seal is
//! damaged.
//!
//! Bearing: dry friction times `1 + c H(t - t_0)` (`relative_change`, -0.95 to 5, prior 0.3). Axis:
//! an additional effort `c H(t - t_0)` (`coulomb_effort` in N or N m, within 1e9, prior 3 times the
//! log's rms effort). `H` is smoothed over 2 ms. Shape: `time_s` in the log's own time (-1e6 to 1e6
//! s, default 0, prior 1e3). A phenomenon, not a law. In a log: friction of two levels, one before
//! and one after the change. Confounded with a thermal drift, with the level of friction if the
//! step is near an end, and with drifting sensors.

use super::kind::{Action, Apply, EffectKind, EffectParameter, Guess, Measure, Values};
use crate::description::{Plant, StepTerm};
use crate::signals::Channel;

const TIME: EffectParameter =
    EffectParameter { scale: 0.02, ..EffectParameter::shape("time_s", "s", 0.0, [-1e6, 1e6], 1e3) };

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "friction-step",
    summary: "Dry friction changes at one time.",
    shows_in: Some(Channel::FrictionTorque),
    confounded_with: &["coulomb-level", "sensor-drift", "thermal-friction-drift"],
    generalises: Some("coulomb-level"),
    guess: Guess::Onset("coulomb-level"),
    actions: &[
        Action {
            plants: Plant::TRANSMISSION,
            parameters: &[EffectParameter::size("relative_change", "1", 0.02, [-0.95, 5.0], 0.3), TIME],
            apply: Apply::Transmission(|bench, parameter| {
                bench.extension.friction_steps.push(term("relative_change", parameter))
            }),
        },
        Action {
            plants: Plant::AXES,
            parameters: &[
                EffectParameter::size("coulomb_effort", "N or N m", 1e-3, [-1e9, 1e9], 3.0)
                    .in_log(Measure::Effort),
                TIME,
            ],
            apply: Apply::Axis(|rig, parameter| {
                rig.extension.friction_steps.push(term("coulomb_effort", parameter))
            }),
        },
    ],
    ..EffectKind::DEFAULT
};

fn term(change: &str, parameter: &Values<'_>) -> StepTerm {
    StepTerm { change: parameter(change), time_s: parameter("time_s") }
}
