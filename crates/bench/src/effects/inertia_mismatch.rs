//! The moving inertia differs from its description.
//!
//! Transmission bench: `J' = J (1 + relative_change)` of the shaft; -0.8 to 4, prior 0.2. Driven
//! axis: inertia or mass `m' = m + inertia_change` in kg m2 or kg, because a description may have
//! 0; within 1e9, prior 3 times the mass that would take the log's rms effort. Body of a mechanism:
//! mass and moment of inertia times `1 + relative_change`. Newton, Euler. In a log: force or effort
//! in proportion to the acceleration. Confounded with the gain of the force sensor if inertia
//! dominates, and with a delay or a lag (under sinusoidal motion the acceleration is proportional
//! to the negative position).

use super::kind::{Action, Apply, EffectKind, EffectParameter, Measure};
use crate::description::{Part, Plant};
use crate::signals::Channel;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "inertia-mismatch",
    summary: "The moving inertia differs from its description.",
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
    actions: &[
        Action {
            plants: Plant::TRANSMISSION,
            parameters: &[EffectParameter::size("relative_change", "1", 0.01, [-0.8, 4.0], 0.2)],
            apply: Apply::Transmission(|bench, parameter| {
                bench.shaft.inertia_kg_m2 *= 1.0 + parameter("relative_change")
            }),
        },
        Action {
            plants: Plant::AXES,
            parameters: &[EffectParameter::size("inertia_change", "kg or kg m2", 1e-3, [-1e9, 1e9], 3.0)
                .in_log(Measure::Inertia)],
            apply: Apply::Axis(|rig, parameter| rig.axis.inertia += parameter("inertia_change")),
        },
        Action {
            plants: Plant::MECHANISM,
            parameters: &[EffectParameter::size("relative_change", "1", 0.01, [-0.8, 4.0], 0.2)],
            apply: Apply::Mechanism(Part::Body, |bench, body, parameter| {
                let Some(body) = bench.body.iter_mut().find(|own| own.name == body) else { return };
                let factor = 1.0 + parameter("relative_change");
                body.inertia_kg_m2 = body.inertia_kg_m2.map(|inertia| inertia * factor);
                body.mass_kg *= factor;
            }),
        },
    ],
    ..EffectKind::DEFAULT
};
