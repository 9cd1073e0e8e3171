//! A single driven axis with given motion and a measured effort: the friction rig, or a linear axis.
//!
//! `effort = load_gain * load + inertia * acceleration + friction`, where friction opposes the motion:
//! `(coulomb_effort +- asymmetry/2 + load_coefficient * |load| * radius) tanh(v/v_r) + viscous_effort * speed`.
//! The effort is the drive's, so friction adds to it while the axis moves forward.

use crate::description::FrictionRig;
use crate::motion::Motion;

/// Effort of the drive and its friction share, in N or N m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Whole effort.
    pub effort: f64,
    /// Friction share, positive while it opposes forward motion.
    pub friction: f64,
}

/// The effort under a motion and a load.
pub fn effort(rig: &FrictionRig, motion: &Motion, load_n: f64) -> Effort {
    let axis = &rig.axis;
    let sign = (motion.rate * axis.friction_radius_m / axis.regularisation_m_s).tanh();
    let dry = axis.coulomb_effort + axis.load_coefficient * load_n.abs() * axis.friction_radius_m;
    let friction =
        dry * sign + 0.5 * axis.coulomb_asymmetry * sign * sign + axis.viscous_effort * motion.rate;
    Effort { effort: axis.load_gain * load_n + axis.inertia * motion.acceleration + friction, friction }
}
