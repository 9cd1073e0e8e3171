//! Viscous friction differs between the two directions.
//!
//! Force `-c_a v s`, `s = tanh(v/v_r)`: the viscous coefficient is larger by `c_a` forward and
//! smaller backward. Servo axes are described in this form (direction-dependent friction,
//! Armstrong-Helouvry 1991). Parameters: `asymmetry_n_s_m` in N s/m (within 1e6, prior 1e3), or
//! `asymmetry_effort` in N s/m or N m s/rad (within 1e9, prior 3 times the log's rms effort over
//! its rms speed). In a log: a force of one sign, proportional to the magnitude of the speed.
//! Confounded with asymmetric dry friction at a nearly constant speed, and with an offset of the
//! effort's sensor.

use super::kind::{Action, Apply, EffectKind, EffectParameter, Measure};
use crate::description::Plant;
use crate::signals::Channel;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "viscous-asymmetry",
    summary: "Viscous friction differs between the two directions.",
    shows_in: Some(Channel::FrictionTorque),
    confounded_with: &[
        "coulomb-asymmetry",
        "inertia-mismatch",
        "position-ripple",
        "sensor-offset",
        "viscous-friction",
    ],
    refines: Some("viscous-friction"),
    actions: &[
        Action {
            plants: Plant::TRANSMISSION,
            parameters: &[EffectParameter::size("asymmetry_n_s_m", "N s/m", 100.0, [-1e6, 1e6], 1e3)],
            apply: Apply::Transmission(|bench, parameter| {
                bench.extension.viscous_asymmetry_n_s_m += parameter("asymmetry_n_s_m")
            }),
        },
        Action {
            plants: Plant::AXES,
            parameters: &[EffectParameter::size(
                "asymmetry_effort",
                "N s/m or N m s/rad",
                1e-3,
                [-1e9, 1e9],
                3.0,
            )
            .in_log(Measure::Drag)],
            apply: Apply::Axis(|rig, parameter| {
                rig.extension.viscous_asymmetry += parameter("asymmetry_effort")
            }),
        },
    ],
    ..EffectKind::DEFAULT
};
