//! Dry friction has another level than described.
//!
//! Bearing: the whole coefficient times `1 + relative_change` (-0.95 to 5, prior 0.3). Axis: a dry effort
//! `coulomb_effort` more, in N or N m, against the motion (within 1e9, prior 1e3), as a description may know no friction.
//! Coulomb's law.
//! In a log: friction of one size that changes its sign with the motion.
//! Confounded with friction that grows with load where the load is constant, with a factor of the torque sensor, and with
//! a step or a drift in a short log.

use super::kind::{EffectKind, EffectParameter, Guess, Plant};
use crate::channel::Channel;
use crate::description::Bench;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "coulomb-level",
    summary: "Dry friction has another level than described.",
    per_channel: false,
    plants: Plant::ALL,
    transmission: &[EffectParameter::size("relative_change", "1", 0.02, [-0.95, 5.0], 0.3)],
    axis: &[EffectParameter::size("coulomb_effort", "N or N m", 0.1, [-1e9, 1e9], 1e3)],
    shows_in: Some(Channel::FrictionTorque),
    confounded_with: &[
        "breakaway",
        "coulomb-asymmetry",
        "friction-step",
        "load-dependent-friction",
        "seal-friction",
        "sensor-gain",
        "stribeck-friction",
        "thermal-friction-drift",
    ],
    guess: Guess::Defaults,
    apply: |bench, _, parameter| match bench {
        Bench::Transmission(bench) => bench.friction.level *= 1.0 + parameter("relative_change"),
        Bench::FrictionRig(rig) => rig.axis.coulomb_effort += parameter("coulomb_effort"),
    },
};
