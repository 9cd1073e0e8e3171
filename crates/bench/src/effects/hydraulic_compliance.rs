//! The oil column between drive cylinder and fork gives way.
//!
//! Fork force `P = k g + c g'` over the gap `g = x_d - x_f`, `k = 1/compliance`, 10 % of critical damping; the crank then has a
//! motion of its own. `k` of a column: bulk modulus times area over length (Merritt, Hydraulic Control Systems, 1967); 20 cm2, 0.3 m and
//! 1.4 GPa give 1.07e-7 m/N for one side, about half of it between two. Parameter: `compliance_m_n`, 0 to 1e-6 m/N, prior 1e-7.
//! A column stiffer than the least step moves the fork by less than the sensors resolve, and would only make the equations stiff.
//! In a log: shaft angle and speed deviate from what the drive's displacement says, in proportion to the drive force.
//! Confounded with play of the fork, with a drive lag where the force follows the speed, and with a shaft that twists.

use super::kind::{EffectKind, EffectParameter, Guess, Plant};
use crate::channel::Channel;
use crate::description::Bench;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "hydraulic-compliance",
    summary: "The hydraulic column between drive cylinder and fork is compliant.",
    per_channel: false,
    plants: &[Plant::Planar],
    transmission: &[EffectParameter::size("compliance_m_n", "m/N", 5e-10, [0.0, 1e-6], 1e-7)],
    axis: &[],
    shows_in: Some(Channel::ShaftAngle),
    confounded_with: &["drive-lag", "fork-backlash", "sensor-offset", "shaft-flexibility"],
    guess: Guess::Defaults,
    apply: |bench, _, parameter| {
        if let Bench::Transmission(bench) = bench {
            bench.extension.hydraulic_compliance_m_n += parameter("compliance_m_n");
        }
    },
};
