//! The seals of a cylinder rub.
//!
//! Transmission bench: dry friction `F_s tanh(v/1 mm/s)` of the load cylinder against the speed `v` of the load crank's pin, which
//! adds to a `[load_friction]` section (`seal_force_n`, 0 to 1e6 N, prior 200 N). On a linear axis a lip that is pressed on by its own preload
//! and by the pressure that it seals (Mueller and Nau, Fluid Sealing Technology, 1998) gives an effort `(preload + share |load|) s`,
//! which is the very sum of `coulomb-level` and `load-dependent-friction`: those two name it there, each with an interval of its
//! own, and this effect is refused.
//! In a log: a force that changes its sign with the motion; on the bench in `drive_force_n` and `bearing_force_y_n`, not in the
//! bearing's friction torque.
//! Confounded with the lever ratio and with friction of the bearing where its torque is not measured.

use super::kind::{EffectKind, EffectParameter, Guess, Plant};
use crate::channel::Channel;
use crate::description::{Bench, LoadFriction};

/// Width of the sign in m/s where the description has no `[load_friction]`.
const SIGN_WIDTH_M_S: f64 = 1e-3;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "seal-friction",
    summary: "The seals of a cylinder rub.",
    per_channel: false,
    plants: &[Plant::Planar, Plant::TwoPlane],
    transmission: &[EffectParameter::size("seal_force_n", "N", 10.0, [0.0, 1e6], 200.0)],
    axis: &[],
    shows_in: Some(Channel::DriveForce),
    confounded_with: &["coulomb-level", "lever-ratio", "load-dependent-friction", "sensor-offset"],
    guess: Guess::Defaults,
    apply: |bench, _, parameter| {
        if let Bench::Transmission(bench) = bench {
            let friction = bench.load_friction.get_or_insert(LoadFriction {
                coulomb_n: 0.0,
                viscous_n_s_m: 0.0,
                regularisation_m_s: SIGN_WIDTH_M_S,
            });
            friction.coulomb_n += parameter("seal_force_n");
        }
    },
};
