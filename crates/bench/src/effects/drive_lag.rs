//! What is driven follows the logged motion late.
//!
//! The plant sees `x(t - lag_s)`. Parameter: `lag_s`, -0.05 to 0.2 s, prior 5 ms. A delay of valve, amplifier or logger.
//! In a log: the shaft's angle, or an axis' effort, is late against the motion by the same time at any speed.
//! Confounded with a delay of the one sensor that shows it, with viscous friction and inertia on a sine, and with a
//! compliant drive where the force follows the speed.

use super::kind::{EffectKind, EffectParameter, Guess, Plant};
use crate::channel::Channel;
use crate::description::Bench;

const LAG: &[EffectParameter] = &[EffectParameter::size("lag_s", "s", 1e-4, [-0.05, 0.2], 5e-3)];

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "drive-lag",
    summary: "What is driven follows the logged motion late.",
    per_channel: false,
    plants: Plant::ALL,
    transmission: LAG,
    axis: LAG,
    shows_in: Some(Channel::ShaftAngle),
    confounded_with: &[
        "fork-backlash",
        "hydraulic-compliance",
        "inertia-mismatch",
        "presliding-hysteresis",
        "sensor-delay",
        "viscous-friction",
    ],
    guess: Guess::Defaults,
    apply: |bench, _, parameter| match bench {
        Bench::Transmission(bench) => bench.extension.drive_lag_s += parameter("lag_s"),
        Bench::FrictionRig(rig) => rig.extension.drive_lag_s += parameter("lag_s"),
    },
};
