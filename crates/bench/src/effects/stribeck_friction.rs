//! Friction falls with speed more than described.
//!
//! Bearing: the coefficient increases by `rise e^(-|v|/v_s)`. Axis: the effort increases by the
//! same with an effort for `rise`. Stribeck curve in Tustin's exponential form (Armstrong-Helouvry,
//! Dupont, Canudas de Wit, Automatica 30, 1994). Parameters: `coefficient_rise` (-1 to 2, prior
//! 0.1) or `effort_rise` in N or N m (within 1e9, prior 3 times the log's rms effort); `speed_m_s`
//! at the friction radius, 1e-4 to 1, default 0.01, prior a factor of 10; on an axis 1e-9 to 1e6,
//! prior a factor of 10 around a tenth of the log's rms speed. In a log: friction peaks
//! on both sides of every reversal, narrow in speed. Confounded with breakaway (which peaks on one
//! side only), with pre-sliding, and over a narrow range of speeds with viscous friction of
//! negative sign.

use super::kind::{Action, Apply, EffectKind, EffectParameter, Measure, Values};
use crate::description::{Plant, StribeckTerm};
use crate::signals::Channel;

/// The speed with its default; the bounds depend on the plant.
const fn speed(bounds: [f64; 2]) -> EffectParameter {
    EffectParameter::magnitude("speed_m_s", "m/s", 0.01, bounds, 10.0)
}

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "stribeck-friction",
    summary: "Friction falls with speed more than described.",
    shows_in: Some(Channel::FrictionTorque),
    confounded_with: &[
        "breakaway",
        "coulomb-level",
        "load-dependent-friction",
        "presliding-hysteresis",
        "viscous-friction",
    ],
    generalises: Some("coulomb-level"),
    is_function_of_speed: true,
    actions: &[
        Action {
            plants: Plant::TRANSMISSION,
            parameters: &[
                EffectParameter::size("coefficient_rise", "1", 0.01, [-1.0, 2.0], 0.1),
                speed([1e-4, 1.0]),
            ],
            apply: Apply::Transmission(|bench, parameter| {
                bench.extension.stribeck.push(term("coefficient_rise", parameter))
            }),
        },
        Action {
            plants: Plant::AXES,
            parameters: &[
                EffectParameter::size("effort_rise", "N or N m", 1e-3, [-1e9, 1e9], 3.0)
                    .in_log(Measure::Effort),
                speed([1e-9, 1e6]).around(0.1, Measure::Speed),
            ],
            apply: Apply::Axis(|rig, parameter| rig.extension.stribeck.push(term("effort_rise", parameter))),
        },
    ],
    ..EffectKind::DEFAULT
};

fn term(rise: &str, parameter: &Values<'_>) -> StribeckTerm {
    StribeckTerm { rise: parameter(rise), speed_m_s: parameter("speed_m_s") }
}
