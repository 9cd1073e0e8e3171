//! Dry friction does not follow the load as described.
//!
//! Bearing: the coefficient times `(N/10 kN)^k` under the normal force `N` (`load_exponent`, -0.9 to 2, prior 0.1); dry plastics
//! have -0.1 to -0.3 over pressure. Axis: an effort `mu |load| r` more (`load_coefficient`, within 5, prior 0.1). Amontons'
//! law and its known deviation for polymers (Bowden and Tabor).
//! In a log: friction out of proportion to the load; visible only where the load varies.
//! Confounded with the level of dry friction under a constant load.

use super::kind::{EffectKind, EffectParameter, Guess, Plant};
use crate::channel::Channel;
use crate::description::Bench;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "load-dependent-friction",
    summary: "Dry friction does not follow the load as described.",
    per_channel: false,
    plants: Plant::ALL,
    transmission: &[EffectParameter::size("load_exponent", "1", 0.02, [-0.9, 2.0], 0.1)],
    axis: &[EffectParameter::size("load_coefficient", "1", 0.002, [-5.0, 5.0], 0.1)],
    shows_in: Some(Channel::FrictionTorque),
    confounded_with: &[
        "coulomb-asymmetry",
        "coulomb-level",
        "seal-friction",
        "stribeck-friction",
        "thermal-friction-drift",
    ],
    guess: Guess::Defaults,
    apply: |bench, _, parameter| match bench {
        Bench::Transmission(bench) => bench.extension.load_exponent += parameter("load_exponent"),
        Bench::FrictionRig(rig) => rig.axis.load_coefficient += parameter("load_coefficient"),
    },
};
