//! Viscous friction differs between the two directions.
//!
//! Force `-c_a v s`, `s = tanh(v/v_r)`: the viscous coefficient is larger by `c_a` forward and smaller backward. Servo axes
//! are described so (direction-dependent friction, Armstrong-Helouvry 1991). Parameters: `asymmetry_n_s_m` in N s/m (within 1e6,
//! prior 1e3), or `asymmetry_effort` in N s/m or N m s/rad (within 1e9, prior 1e3).
//! In a log: a force of one sign, proportional to the size of the speed.
//! Confounded with asymmetric dry friction at a nearly constant speed, and with an offset of the effort's sensor.

use super::kind::{EffectKind, EffectParameter, Guess, Plant};
use crate::channel::Channel;
use crate::description::Bench;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "viscous-asymmetry",
    summary: "Viscous friction differs between the two directions.",
    per_channel: false,
    plants: Plant::ALL,
    transmission: &[EffectParameter::size("asymmetry_n_s_m", "N s/m", 100.0, [-1e6, 1e6], 1e3)],
    axis: &[EffectParameter::size("asymmetry_effort", "N s/m or N m s/rad", 1.0, [-1e9, 1e9], 1e3)],
    shows_in: Some(Channel::FrictionTorque),
    confounded_with: &[
        "coulomb-asymmetry",
        "inertia-mismatch",
        "position-ripple",
        "sensor-offset",
        "viscous-friction",
    ],
    guess: Guess::Defaults,
    apply: |bench, _, parameter| match bench {
        Bench::Transmission(bench) => {
            bench.extension.viscous_asymmetry_n_s_m += parameter("asymmetry_n_s_m");
        }
        Bench::FrictionRig(rig) => rig.extension.viscous_asymmetry += parameter("asymmetry_effort"),
    },
};
