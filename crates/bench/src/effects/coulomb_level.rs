//! Dry friction has another level than described.
//!
//! Bearing: the total coefficient times `1 + relative_change` (-0.95 to 5, prior 0.3). Axis: an
//! additional dry effort `coulomb_effort` against the motion, in N or N m (within 1e9, prior 3
//! times the log's rms effort), because a description may have no friction. Joint of a mechanism:
//! `coefficient_change`, added to the coefficients of its contacts and limited to a sum of 0 (-1 to
//! 2, prior 0.1). Coulomb's law. In a log: friction of constant size that changes its sign with the
//! motion. Confounded with load-dependent friction at a constant load, with the gain of the torque
//! sensor, and with a step or a drift in a short log.

use super::kind::{Action, Apply, EffectKind, EffectParameter, Measure};
use crate::description::{Part, Plant};
use crate::signals::Channel;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "coulomb-level",
    summary: "Dry friction has another level than described.",
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
    actions: &[
        Action {
            plants: Plant::TRANSMISSION,
            parameters: &[EffectParameter::size("relative_change", "1", 0.02, [-0.95, 5.0], 0.3)],
            apply: Apply::Transmission(|bench, parameter| {
                bench.friction.level *= 1.0 + parameter("relative_change")
            }),
        },
        Action {
            plants: Plant::AXES,
            parameters: &[EffectParameter::size("coulomb_effort", "N or N m", 1e-3, [-1e9, 1e9], 3.0)
                .in_log(Measure::Effort)],
            apply: Apply::Axis(|rig, parameter| rig.axis.coulomb_effort += parameter("coulomb_effort")),
        },
        Action {
            plants: Plant::MECHANISM,
            parameters: &[EffectParameter::size("coefficient_change", "1", 0.005, [-1.0, 2.0], 0.1)],
            apply: Apply::Mechanism(Part::Contact, |bench, joint, parameter| {
                let Some(contact) = bench.own_contact_mut(joint) else { return };
                let sum = |coefficient: f64| (coefficient + parameter("coefficient_change")).max(0.0);
                contact.static_coefficient = contact.static_coefficient.map(sum);
                contact.coulomb_coefficient = sum(contact.coulomb_coefficient);
            }),
        },
    ],
    ..EffectKind::DEFAULT
};
