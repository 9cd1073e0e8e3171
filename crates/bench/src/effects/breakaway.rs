//! Static friction grows with the time at standstill and is lost by sliding.
//!
//! `m' = (1 - m)/t_r - |v| m/d`, the ageing law of rate-and-state friction (Dieterich 1979, Ruina
//! 1983) with its state between 0 and 1. Bearing: dry friction times `1 + excess m` (`excess`, -0.9
//! to 5, prior 0.3). Axis: an additional effort `excess m` (`excess_effort` in N or N m, within
//! 1e9, prior 3 times the log's rms effort). Shapes: `rest_time_s` 1e-3 to 1e3, default 0.5;
//! `distance_m` 1e-6 to 0.1, default 2e-4; the prior of both is a factor of 10. On an axis the
//! distance is within 1e-9 to 1e6, its prior around a hundredth of half the stroke. At the start of
//! a log, a part at standstill has been there for a long time, and a moving part has the state of
//! steady sliding. In a log: a peak of friction after each standstill or reversal, which is lost
//! over the distance. Confounded with Stribeck friction (which also peaks before a reversal) and,
//! without standstills, with pre-sliding.

use super::kind::{Action, Apply, EffectKind, EffectParameter, Measure, Values};
use crate::description::{BreakawayTerm, Plant};
use crate::signals::Channel;

const REST: EffectParameter = EffectParameter::magnitude("rest_time_s", "s", 0.5, [1e-3, 1e3], 10.0);

/// The distance with its default; the bounds depend on the plant.
const fn distance(bounds: [f64; 2]) -> EffectParameter {
    EffectParameter::magnitude("distance_m", "m", 2e-4, bounds, 10.0)
}

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "breakaway",
    summary: "Static friction grows with the time at standstill and is lost by sliding.",
    shows_in: Some(Channel::FrictionTorque),
    confounded_with: &["coulomb-level", "presliding-hysteresis", "stribeck-friction"],
    generalises: Some("coulomb-level"),
    actions: &[
        Action {
            plants: &[Plant::Planar],
            parameters: &[
                EffectParameter::size("excess", "1", 0.05, [-0.9, 5.0], 0.3),
                REST,
                distance([1e-6, 0.1]),
            ],
            apply: Apply::Transmission(|bench, parameter| {
                bench.extension.breakaway = Some(term("excess", parameter))
            }),
        },
        Action {
            plants: Plant::AXES,
            parameters: &[
                EffectParameter::size("excess_effort", "N or N m", 1e-3, [-1e9, 1e9], 3.0)
                    .in_log(Measure::Effort),
                REST,
                distance([1e-9, 1e6]).around(0.01, Measure::Distance),
            ],
            apply: Apply::Axis(|rig, parameter| {
                rig.extension.breakaway = Some(term("excess_effort", parameter))
            }),
        },
    ],
    ..EffectKind::DEFAULT
};

fn term(excess: &str, parameter: &Values<'_>) -> BreakawayTerm {
    BreakawayTerm {
        excess: parameter(excess),
        rest_time_s: parameter("rest_time_s"),
        distance_m: parameter("distance_m"),
    }
}
