//! A spring, or another effort proportional to the position, is missing.
//!
//! Effort `k (x - x_0)` of an axis at position `x`, with `x_0` the described `neutral_position`.
//! Springs, hoses, cables and the weight of an arm near its lower equilibrium have this form. A
//! spring at another neutral position also has a constant part, which a diagnosis finds as the
//! offset of the effort. Parameter: `stiffness` in N/m or N m/rad (within 1e12, prior 3 times the
//! log's rms effort over half the stroke). At a pin of a mechanism: a torsion spring between its
//! bodies, free at the start, `torsion_nm_rad` in N m/rad (within 1e12, prior 3 times the drive's
//! rms torque over half its range). In a log: force over position is inclined. Confounded
//! with inertia under one sine (the acceleration is proportional to the negative position), until
//! the frequency changes.

use super::kind::{Action, Apply, EffectKind, EffectParameter, Measure};
use crate::description::{Part, Plant};
use crate::signals::Channel;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "spring-effort",
    summary: "A spring, or another effort proportional to the position, is missing.",
    shows_in: Some(Channel::DriveForce),
    confounded_with: &["inertia-mismatch", "position-ripple", "load-gain"],
    actions: &[
        Action {
            plants: Plant::AXES,
            parameters: &[EffectParameter::size("stiffness", "N/m or N m/rad", 1e-3, [-1e12, 1e12], 3.0)
                .in_log(Measure::Stiffness)],
            apply: Apply::Axis(|rig, parameter| rig.axis.spring_stiffness += parameter("stiffness")),
        },
        Action {
            plants: Plant::MECHANISM,
            parameters: &[EffectParameter::size("torsion_nm_rad", "N m/rad", 1e-3, [-1e12, 1e12], 3.0)
                .in_log(Measure::Stiffness)],
            apply: Apply::Mechanism(Part::Pin, |bench, joint, parameter| {
                bench.add_torsion(joint, parameter("torsion_nm_rad"), 0.0);
            }),
        },
    ],
    ..EffectKind::DEFAULT
};
