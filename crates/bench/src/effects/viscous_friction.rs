//! Friction proportional to speed.
//!
//! Bearing: force `-c v` on the journal at the sliding speed `v`, `viscous_n_s_m` in N s/m (within 1e6, prior 1e4). Axis:
//! effort `c` times its speed, `viscous_effort` in N s/m or N m s/rad (within 1e9, prior 1e3). Newton's law of viscosity.
//! In a log: friction that follows the speed through zero, forward and backward alike.
//! Confounded with a delay or lag of a sinusoidal motion (both shift a force by a quarter of a period), with Stribeck's fall of
//! the other sign, and with the asymmetric viscous friction where the motion is mostly one way.

use super::kind::{EffectKind, EffectParameter, Guess, Plant};
use crate::channel::Channel;
use crate::description::Bench;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "viscous-friction",
    summary: "A friction force proportional to speed is missing.",
    per_channel: false,
    plants: Plant::ALL,
    transmission: &[EffectParameter::size("viscous_n_s_m", "N s/m", 100.0, [-1e6, 1e6], 1e4)],
    axis: &[EffectParameter::size("viscous_effort", "N s/m or N m s/rad", 1.0, [-1e9, 1e9], 1e3)],
    shows_in: Some(Channel::FrictionTorque),
    confounded_with: &["drive-lag", "sensor-delay", "sensor-gain", "stribeck-friction", "viscous-asymmetry"],
    guess: Guess::Defaults,
    apply: |bench, _, parameter| match bench {
        Bench::Transmission(bench) => bench.extension.viscous_n_s_m += parameter("viscous_n_s_m"),
        Bench::FrictionRig(rig) => rig.axis.viscous_effort += parameter("viscous_effort"),
    },
};
