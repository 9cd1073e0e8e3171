//! The plant follows the logged motion with a lag.
//!
//! The plant moves by `x(t - lag_s)`. Parameter: `lag_s`, -0.05 to 0.2 s, prior 5 ms. The cause is
//! a delay of valve, amplifier or logger. In a log: the shaft's angle, or an axis' effort, is late
//! relative to the motion by the same time at any speed. Confounded with a delay of the one sensor
//! that shows it, with viscous friction and inertia under sinusoidal motion, and with a compliant
//! drive if the force follows the speed.

use super::kind::{Action, Apply, EffectKind, EffectParameter};
use crate::description::Plant;
use crate::signals::Channel;

const LAG: &[EffectParameter] = &[EffectParameter::size("lag_s", "s", 1e-4, [-0.05, 0.2], 5e-3)];

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "drive-lag",
    summary: "The plant follows the logged motion with a lag.",
    shows_in: Some(Channel::ShaftAngle),
    confounded_with: &[
        "fork-backlash",
        "hydraulic-compliance",
        "inertia-mismatch",
        "presliding-hysteresis",
        "sensor-delay",
        "viscous-friction",
    ],
    actions: &[
        Action {
            plants: Plant::TRANSMISSION,
            parameters: LAG,
            apply: Apply::Transmission(|bench, parameter| bench.extension.drive_lag_s += parameter("lag_s")),
        },
        Action {
            plants: Plant::AXES,
            parameters: LAG,
            apply: Apply::Axis(|rig, parameter| rig.extension.drive_lag_s += parameter("lag_s")),
        },
    ],
    ..EffectKind::DEFAULT
};
