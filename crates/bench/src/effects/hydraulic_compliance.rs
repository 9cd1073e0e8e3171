//! The oil column between drive cylinder and fork is compliant.
//!
//! Fork force `P = k g + c g'` over the gap `g = x_d - x_f`, `k = 1/compliance`, 10 % of critical
//! damping; the crank then moves as a separate state. `k` of a column: bulk modulus times area over
//! length (Merritt, Hydraulic Control Systems, 1967). 20 cm2, 0.3 m and 1.4 GPa give 1.07e-7 m/N
//! for one side, and about half of it for two. Parameter: `compliance_m_n`, 0 to 1e-6 m/N, prior
//! 1e-7. A column below a minimum compliance counts as rigid: it would move the fork by less than
//! the sensors resolve, and only make the equations stiff. In a log: shaft angle and speed deviate
//! from those of the drive's displacement, in proportion to the drive force. Confounded with play
//! of the fork, with a drive lag if the force follows the speed, and with a flexible shaft.

use super::kind::{Action, Apply, EffectKind, EffectParameter};
use crate::description::Plant;
use crate::signals::Channel;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "hydraulic-compliance",
    summary: "The hydraulic column between drive cylinder and fork is compliant.",
    shows_in: Some(Channel::ShaftAngle),
    confounded_with: &["drive-lag", "fork-backlash", "sensor-offset", "shaft-flexibility"],
    actions: &[Action {
        plants: &[Plant::Planar],
        parameters: &[EffectParameter::size("compliance_m_n", "m/N", 5e-10, [0.0, 1e-6], 1e-7)],
        apply: Apply::Transmission(|bench, parameter| {
            bench.extension.hydraulic_compliance_m_n += parameter("compliance_m_n")
        }),
    }],
    ..EffectKind::DEFAULT
};
