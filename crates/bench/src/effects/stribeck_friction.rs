//! Friction falls with speed, and the description lacks the fall or has too little of it.
//!
//! Bearing: the coefficient grows by `rise e^(-|v|/v_s)`; axis: the effort by the same with an effort for `rise`. Stribeck's
//! curve in Tustin's exponential form (Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30, 1994). Parameters: `coefficient_rise`
//! (-1 to 2, prior 0.1) or `effort_rise` in N or N m (within 1e9, prior 1e3); `speed_m_s` at the friction radius, 1e-4 to 1,
//! 0.01 unless given, prior a factor of 10.
//! In a log: friction peaks on both sides of every reversal, narrow in speed.
//! Confounded with static friction after a rest (peaks on one side only), with pre-sliding, and over a narrow range of speeds
//! with viscous friction of negative sign.

use super::kind::{EffectKind, EffectParameter, Guess, Plant};
use crate::channel::Channel;
use crate::description::{Bench, StribeckTerm};

const SPEED: EffectParameter = EffectParameter::magnitude("speed_m_s", "m/s", 0.01, [1e-4, 1.0], 10.0);

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "stribeck-friction",
    summary: "Friction falls with speed more than described.",
    per_channel: false,
    plants: Plant::ALL,
    transmission: &[EffectParameter::size("coefficient_rise", "1", 0.01, [-1.0, 2.0], 0.1), SPEED],
    axis: &[EffectParameter::size("effort_rise", "N or N m", 0.1, [-1e9, 1e9], 1e3), SPEED],
    shows_in: Some(Channel::FrictionTorque),
    confounded_with: &[
        "breakaway",
        "coulomb-level",
        "load-dependent-friction",
        "presliding-hysteresis",
        "viscous-friction",
    ],
    guess: Guess::Defaults,
    apply: |bench, _, parameter| {
        let term = |rise: &str| StribeckTerm { rise: parameter(rise), speed_m_s: parameter("speed_m_s") };
        match bench {
            Bench::Transmission(bench) => bench.extension.stribeck.push(term("coefficient_rise")),
            Bench::FrictionRig(rig) => rig.extension.stribeck.push(term("effort_rise")),
        }
    },
};
