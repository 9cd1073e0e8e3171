//! Friction depends on the temperature rise that it causes.
//!
//! `dT' = (R_th P - dT)/tau` with the heat `P` of friction. Dry friction is multiplied by `1 + b
//! dT`, limited to 0 to 3 against thermal runaway. One lumped heat capacity (Newton's law of
//! cooling), linear in temperature. Parameters: `level_per_k` in 1/K (within 0.5, prior 0.02);
//! shapes `resistance_k_w` in K/W (1e-4 to 100, default 0.1, prior 0.05) and `time_constant_s` (0.5
//! to 1e5, default 20, prior a factor of 5). The minimum of half a second corresponds to ten grams
//! of steel with 0.1 K/W. A log without temperature determines only the products of the parameters.
//! In a log: friction drifts over many cycles, fast where much heat is generated. Confounded with a
//! step of friction, a drift of the torque's sensor, and in a short log with the level of friction.

use super::kind::{Action, Apply, EffectKind, EffectParameter, Values};
use crate::description::{Plant, ThermalTerm};
use crate::signals::Channel;

const PARAMETERS: &[EffectParameter] = &[
    EffectParameter::size("level_per_k", "1/K", 1e-3, [-0.5, 0.5], 0.02),
    EffectParameter::shape("resistance_k_w", "K/W", 0.1, [1e-4, 100.0], 0.05),
    EffectParameter::magnitude("time_constant_s", "s", 20.0, [0.5, 1e5], 5.0),
];

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "thermal-friction-drift",
    summary: "Friction depends on the temperature rise that it causes.",
    shows_in: Some(Channel::FrictionTorque),
    confounded_with: &["coulomb-level", "friction-step", "load-dependent-friction", "sensor-drift"],
    generalises: Some("coulomb-level"),
    actions: &[
        Action {
            plants: &[Plant::Planar],
            parameters: PARAMETERS,
            apply: Apply::Transmission(|bench, parameter| bench.extension.thermal = Some(term(parameter))),
        },
        Action {
            plants: Plant::AXES,
            parameters: PARAMETERS,
            apply: Apply::Axis(|rig, parameter| rig.extension.thermal = Some(term(parameter))),
        },
    ],
    ..EffectKind::DEFAULT
};

fn term(parameter: &Values<'_>) -> ThermalTerm {
    ThermalTerm {
        level_per_k: parameter("level_per_k"),
        resistance_k_w: parameter("resistance_k_w"),
        time_constant_s: parameter("time_constant_s"),
    }
}
