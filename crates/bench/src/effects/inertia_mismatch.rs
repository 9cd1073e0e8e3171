//! The moving inertia differs from its description.
//!
//! Transmission bench: `J' = J (1 + relative_change)` of the shaft; -0.8 to 4, prior 0.2. Driven axis: inertia or mass
//! `m' = m + inertia_change` in kg m2 or kg, as a description may leave it at 0; within 1e9, prior 1e3. Newton, Euler.
//! In a log: force or effort in proportion to the acceleration.
//! Confounded with a factor of the force sensor where inertia dominates, and with a delay or a lag (a sine's
//! acceleration is its position with the sign changed).

use super::kind::{EffectKind, EffectParameter, Guess, Plant};
use crate::channel::Channel;
use crate::description::Bench;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "inertia-mismatch",
    summary: "The moving inertia differs from its description.",
    per_channel: false,
    plants: Plant::ALL,
    transmission: &[EffectParameter::size("relative_change", "1", 0.01, [-0.8, 4.0], 0.2)],
    axis: &[EffectParameter::size("inertia_change", "kg or kg m2", 0.1, [-1e9, 1e9], 1e3)],
    shows_in: Some(Channel::DriveForce),
    confounded_with: &[
        "drive-lag",
        "lever-ratio",
        "load-ripple",
        "position-ripple",
        "sensor-delay",
        "sensor-gain",
        "shaft-flexibility",
        "viscous-asymmetry",
    ],
    guess: Guess::Defaults,
    apply: |bench, _, parameter| match bench {
        Bench::Transmission(bench) => bench.shaft.inertia_kg_m2 *= 1.0 + parameter("relative_change"),
        Bench::FrictionRig(rig) => rig.axis.inertia += parameter("inertia_change"),
    },
};
