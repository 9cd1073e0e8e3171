//! Dry friction differs between the two directions.
//!
//! Bearing: the coefficient times `1 + a s`, `s = tanh(v/v_r)` (`asymmetry`, -1 to 1, prior 0.1). Axis: an effort `a s^2/2`
//! whatever the direction, so friction differs by `asymmetry_effort` between forward and backward, in N or N m (within 1e9,
//! prior 1e3). Direction-dependent Coulomb friction (Armstrong-Helouvry 1991).
//! In a log: a force of one sign while anything moves, gone at rest.
//! Confounded with an offset of the effort's sensor, from which only rests and reversals tell it.

use super::kind::{EffectKind, EffectParameter, Guess, Plant};
use crate::channel::Channel;
use crate::description::Bench;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "coulomb-asymmetry",
    summary: "Dry friction differs between the two directions.",
    per_channel: false,
    plants: Plant::ALL,
    transmission: &[EffectParameter::size("asymmetry", "1", 0.02, [-1.0, 1.0], 0.1)],
    axis: &[EffectParameter::size("asymmetry_effort", "N or N m", 0.1, [-1e9, 1e9], 1e3)],
    shows_in: Some(Channel::FrictionTorque),
    confounded_with: &[
        "coulomb-level",
        "load-dependent-friction",
        "sensor-drift",
        "sensor-offset",
        "viscous-asymmetry",
    ],
    guess: Guess::Defaults,
    apply: |bench, _, parameter| match bench {
        Bench::Transmission(bench) => bench.extension.coulomb_asymmetry += parameter("asymmetry"),
        Bench::FrictionRig(rig) => rig.axis.coulomb_asymmetry += parameter("asymmetry_effort"),
    },
};
