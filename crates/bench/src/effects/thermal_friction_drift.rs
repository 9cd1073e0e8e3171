//! Friction follows the temperature that it causes.
//!
//! `dT' = (R_th P - dT)/tau` with the heat `P` of friction, dry friction times `1 + b dT`, held within 0 to 3
//! (friction that grows by its own heat would run away). One lumped heat capacity
//! (Newton's law of cooling), linear in temperature. Parameters: `level_per_k` in 1/K (within 0.5, prior 0.02); shapes
//! `resistance_k_w` in K/W (1e-4 to 100, 0.1 unless given, prior 0.05) and `time_constant_s` (0.5 to 1e5, 20 unless given,
//! prior a factor of 5): ten grams of steel behind 0.1 K/W have half a second. A log without temperature tells only their products.
//! In a log: friction drifts over many cycles, fast where much heat is made.
//! Confounded with a step of friction, a drift of the torque's sensor, and in a short log with the level of friction.

use super::kind::{EffectKind, EffectParameter, Guess, Plant};
use crate::channel::Channel;
use crate::description::{Bench, ThermalTerm};

const PARAMETERS: &[EffectParameter] = &[
    EffectParameter::size("level_per_k", "1/K", 1e-3, [-0.5, 0.5], 0.02),
    EffectParameter::shape("resistance_k_w", "K/W", 0.1, [1e-4, 100.0], 0.05),
    EffectParameter::magnitude("time_constant_s", "s", 20.0, [0.5, 1e5], 5.0),
];

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "thermal-friction-drift",
    summary: "Friction follows the temperature that it causes.",
    per_channel: false,
    plants: &[Plant::Planar, Plant::Rotary, Plant::Linear],
    transmission: PARAMETERS,
    axis: PARAMETERS,
    shows_in: Some(Channel::FrictionTorque),
    confounded_with: &["coulomb-level", "friction-step", "load-dependent-friction", "sensor-drift"],
    guess: Guess::Defaults,
    apply: |bench, _, parameter| {
        let term = ThermalTerm {
            level_per_k: parameter("level_per_k"),
            resistance_k_w: parameter("resistance_k_w"),
            time_constant_s: parameter("time_constant_s"),
        };
        match bench {
            Bench::Transmission(bench) => bench.extension.thermal = Some(term),
            Bench::FrictionRig(rig) => rig.extension.thermal = Some(term),
        }
    },
};
