//! Friction of the seals of a cylinder.
//!
//! Transmission bench: dry friction `F_s tanh(v/1 mm/s)` of the load cylinder against the speed `v`
//! of the load crank's pin, in addition to a `[load_friction]` section (`seal_force_n`, 0 to 1e6 N,
//! prior 200 N). On a linear axis a seal lip is pressed on by its preload and by the pressure that
//! it seals (Mueller and Nau, Fluid Sealing Technology, 1998). This gives an effort `(preload +
//! share |load|) s`, which is the sum of `coulomb-level` and `load-dependent-friction`. So on an
//! axis those two effects describe it, each with its own interval, and this effect is refused. In a
//! log: a force that changes its sign with the motion; on the bench in `drive_force_n` and
//! `bearing_force_y_n`, not in the bearing's friction torque. Confounded with the lever ratio, and
//! with friction of the bearing if its torque is not measured.

use super::kind::{Action, Apply, EffectKind, EffectParameter};
use crate::description::{LoadFriction, Plant};
use crate::signals::Channel;

/// Width of the sign in m/s if the description has no `[load_friction]`.
const SIGN_WIDTH_M_S: f64 = 1e-3;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "seal-friction",
    summary: "Friction of the seals of a cylinder is missing.",
    shows_in: Some(Channel::DriveForce),
    confounded_with: &["coulomb-level", "lever-ratio", "load-dependent-friction", "sensor-offset"],
    actions: &[Action {
        plants: Plant::TRANSMISSION,
        parameters: &[EffectParameter::size("seal_force_n", "N", 10.0, [0.0, 1e6], 200.0)],
        apply: Apply::Transmission(|bench, parameter| {
            let friction = bench.load_friction.get_or_insert(LoadFriction {
                coulomb_n: 0.0,
                viscous_n_s_m: 0.0,
                regularisation_m_s: SIGN_WIDTH_M_S,
            });
            friction.coulomb_n += parameter("seal_force_n");
        }),
    }],
    ..EffectKind::DEFAULT
};
