//! The journal is oval: its radius varies over the shaft's angle.
//!
//! Radius deviation in the direction `b` of the journal's own frame: `rho(b) = c cos 2b + s sin
//! 2b`, `b = psi - th` with `psi` the direction of the contact and `th` the shaft's angle. To first
//! order in `rho/a` the deformation is `d = a - D + rho(psi - th)`. The normal force acts along the
//! gradient of `d`, so in addition to `n` it has the share `rho'/a` across and the torque `F_n
//! rho'` on the shaft (virtual work). Roundness as a Fourier series of the radius: ISO 12181-1;
//! only the second harmonic, the ovality, is modelled. Parameters: `cosine_m`, `sine_m`, within 0.2
//! mm, prior 10 um each. In a log: `journal_y_m` and `journal_z_m` deviate by an amount that
//! follows twice the angle between shaft and contact, and repeats with it. Confounded with
//! clearance wear (the crank turns through 35 degrees only, so part of it looks constant) and with
//! offsets of the journal's sensors.

use super::kind::{Action, Apply, EffectKind, EffectParameter};
use crate::description::Plant;
use crate::signals::Channel;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "journal-out-of-round",
    summary: "The journal is oval: its radius varies over the shaft's angle.",
    shows_in: Some(Channel::JournalY),
    confounded_with: &["clearance-wear", "contact-stiffness", "sensor-gain", "sensor-offset"],
    actions: &[Action {
        plants: &[Plant::Planar],
        parameters: &[
            EffectParameter::size("cosine_m", "m", 1e-6, [-2e-4, 2e-4], 1e-5),
            EffectParameter::size("sine_m", "m", 1e-6, [-2e-4, 2e-4], 1e-5),
        ],
        apply: Apply::Transmission(|bench, parameter| {
            bench.extension.out_of_round_m[0] += parameter("cosine_m");
            bench.extension.out_of_round_m[1] += parameter("sine_m");
        }),
    }],
    ..EffectKind::DEFAULT
};
