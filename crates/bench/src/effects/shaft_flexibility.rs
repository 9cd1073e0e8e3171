//! The shaft is flexible in torsion between drive crank and load crank.
//!
//! Half of the moment of inertia turns with the drive crank and the bearing, half with the load
//! crank. Between them is a torsional spring with 2 % of critical damping:
//!
//! ```text
//! (J/2) th''  = P R_d cos th + T_f + q      (J/2) th_l'' = F_L R_l cos th_l - q
//! q = k (th_l - th) + c (th_l' - th'),  k = 1/compliance,  c = 2 .02 sqrt(k J/4)
//! ```
//!
//! Source: any text on torsional vibration of two-disk shafts (Den Hartog, Mechanical Vibrations);
//! the division into halves is an assumption. Parameter: `compliance_rad_nm`, 0 to 1e-5, prior 1e-6
//! (steel, 100 mm thick, 0.5 m long: 6.4e-7). In a log: a lightly damped oscillation at `sqrt(4
//! k/J)/2 pi` in `drive_force_n` and the bearing force after each change of load; the load acts on
//! a compliant shaft. Confounded with a compliant hydraulic column (a spring on the other side of
//! the same inertia) and, far below the resonance, with inertia.

use super::kind::{Action, Apply, EffectKind, EffectParameter};
use crate::description::Plant;
use crate::signals::Channel;

pub(super) const EFFECT: EffectKind = EffectKind {
    name: "shaft-flexibility",
    summary: "The shaft is flexible in torsion between drive crank and load crank.",
    shows_in: Some(Channel::DriveForce),
    confounded_with: &["hydraulic-compliance", "inertia-mismatch", "lever-ratio"],
    actions: &[Action {
        plants: &[Plant::Planar],
        parameters: &[EffectParameter::size("compliance_rad_nm", "rad/(N m)", 2e-8, [0.0, 1e-5], 1e-6)],
        apply: Apply::Transmission(|bench, parameter| {
            bench.extension.shaft_compliance_rad_nm += parameter("compliance_rad_nm")
        }),
    }],
    ..EffectKind::DEFAULT
};
