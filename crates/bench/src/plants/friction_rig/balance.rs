//! Balance of an axis at one moment: friction, effort of the drive, and the memory after a step.

use crate::description::{Axis, FrictionRig, Rubbing};
use crate::signals::Motion;

/// Number of widths beyond which the sign is 1 within rounding.
const SATURATION_WIDTHS: f64 = 20.0;
/// Number of bending lengths beyond which the initial state of the bristles has no influence.
const MAX_BENDS: f64 = 40.0;

/// Effort of the drive and its friction share, in N or N m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Total effort.
    pub effort: f64,
    /// Friction share, positive while it opposes forward motion.
    pub friction: f64,
}

/// Memory of an axis' friction.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::plants) struct AxisMemory {
    /// Excess of the rubbing pair's static friction.
    pub(in crate::plants) excess: f64,
    /// Pre-sliding sign, from -1 to 1.
    pub(in crate::plants) turned: f64,
    /// Share of the excess that a standstill has built up.
    breakaway: f64,
    /// Temperature rise in K.
    rise_k: f64,
}

impl AxisMemory {
    /// Memory at the start. An axis that moves has its bristles bent that way, with the memory of
    /// this speed in steady sliding. An axis at standstill has been there for a long time.
    pub(in crate::plants) fn of_steady_sliding(rig: &FrictionRig, slides: &Sliding) -> Self {
        let extension = &rig.extension;
        Self {
            turned: slides.sign,
            breakaway: extension.breakaway.as_ref().map_or(0.0, |term| term.steady(slides.speed_m_s).0),
            rise_k: extension.temperature_start_k,
            ..Self::default()
        }
    }
}

/// State of the axis at one time: motion, load with its ripples, coefficient of the rubbing pair.
pub(in crate::plants) struct Moment {
    pub(in crate::plants) time_s: f64,
    pub(in crate::plants) motion: Motion,
    pub(in crate::plants) load_n: f64,
    pub(in crate::plants) coefficient: f64,
}

/// Regularised sign of a sliding speed with the described width.
///
/// `tanh` through one exponential: exact to the rounding of 1, which is enough for friction. The
/// library's function is also exact for tiny results, and slower.
pub(in crate::plants) fn sign(rig: &FrictionRig, sliding_m_s: f64) -> f64 {
    let widths = sliding_m_s / rig.axis.regularisation_m_s;
    let fallen = (-2.0 * widths.abs().min(SATURATION_WIDTHS)).exp();
    ((1.0 - fallen) / (1.0 + fallen)).copysign(widths)
}

/// Friction at a moment, under the motion of the rubbing part.
pub(super) fn friction_at(rig: &FrictionRig, now: &Moment, rubbing: &Motion, memory: &AxisMemory) -> f64 {
    let (axis, extension) = (&rig.axis, &rig.extension);
    let speed = rubbing.rate * axis.friction_radius_m;
    let sign = sign(rig, speed);
    let load_dependent =
        (axis.load_coefficient + now.coefficient) * now.load_n.abs() * axis.friction_radius_m;
    let at = Rubbing {
        time_s: now.time_s,
        displacement: rubbing.value - axis.neutral_position,
        rate: rubbing.rate,
        sliding_m_s: speed,
        sign,
        breakaway: memory.breakaway,
        rise_k: memory.rise_k,
    };
    let dry = extension.dry_friction(axis.coulomb_effort + load_dependent, &at);
    let turned = if extension.presliding_distance_m > 0.0 { memory.turned } else { sign };
    dry * turned
        + 0.5 * axis.coulomb_asymmetry * sign * sign
        + axis.viscous_effort * rubbing.rate
        + extension.viscous_friction(&at)
}

/// Moment of gravity on a rotary axis at an angle in rad.
fn gravity_moment(axis: &Axis, angle_rad: f64) -> f64 {
    if axis.gravity_cos == 0.0 && axis.gravity_sin == 0.0 {
        return 0.0;
    }
    let (sin, cos) = angle_rad.sin_cos();
    axis.gravity_cos * cos + axis.gravity_sin * sin
}

/// Effort at a moment, under the motion of the rubbing part.
pub(in crate::plants) fn effort_at(
    rig: &FrictionRig,
    now: &Moment,
    rubbing: &Motion,
    memory: &AxisMemory,
) -> Effort {
    let axis = &rig.axis;
    let friction = friction_at(rig, now, rubbing, memory);
    let added = rig.extension.effort(&now.motion);
    let spring = axis.spring_stiffness * (now.motion.value - axis.neutral_position);
    let load = axis.load_gain * now.load_n;
    let inertial = axis.inertia * now.motion.acceleration;
    let given = axis.constant_effort + gravity_moment(axis, now.motion.value);
    Effort { effort: load + inertial + friction + added + given + spring, friction }
}

/// Returns the memory after a step, with the motion at one moment taken for the step.
pub(in crate::plants) fn memory_after(
    rig: &FrictionRig,
    now: &Moment,
    rubbing: &Motion,
    last: AxisMemory,
    step_s: f64,
) -> AxisMemory {
    let extension = &rig.extension;
    let sliding = (rubbing.rate * rig.axis.friction_radius_m).abs();
    let mut next = last;
    if let Some(surface) = &rig.surface {
        next.excess = surface.excess_after(last.excess, sliding, step_s);
    }
    if let Some(term) = &extension.breakaway {
        let (steady, rate) = term.steady(sliding);
        next.breakaway = steady + (last.breakaway - steady) * (-rate * step_s).exp();
    }
    if let Some(term) = &extension.thermal {
        let heat = (friction_at(rig, now, rubbing, &last) * rubbing.rate).max(0.0);
        let steady = term.resistance_k_w * heat;
        next.rise_k = steady + (last.rise_k - steady) * (-step_s / term.time_constant_s).exp();
    }
    next
}

/// Sliding speed with its sign.
#[derive(Clone, Copy)]
pub(in crate::plants) struct Sliding {
    pub(in crate::plants) speed_m_s: f64,
    pub(in crate::plants) sign: f64,
}

impl Sliding {
    pub(super) fn new(rig: &FrictionRig, motion: &Motion) -> Self {
        let speed_m_s = motion.rate * rig.axis.friction_radius_m;
        Self { speed_m_s, sign: sign(rig, speed_m_s) }
    }
}

/// Pre-sliding sign after a step from one sliding state to another, over which the sign changes
/// linearly. As the distance goes to 0 the result becomes the sign at the end of the step.
pub(in crate::plants) fn presliding_sign(
    distance_m: f64,
    last: f64,
    [begin, end]: [Sliding; 2],
    step_s: f64,
) -> f64 {
    let (from, to) = (begin.speed_m_s, end.speed_m_s);
    // Mean of the magnitude of a speed that changes linearly.
    let mean = if from * to < 0.0 {
        0.5 * (from * from + to * to) / (from - to).abs()
    } else {
        0.5 * (from + to).abs()
    };
    let bends = mean * step_s / distance_m;
    let gone = -(-bends.min(MAX_BENDS)).exp_m1();
    let lagging = if bends > 1e-6 { gone / bends } else { 1.0 - 0.5 * bends };
    end.sign + (last - begin.sign) * (1.0 - gone) - (end.sign - begin.sign) * lagging
}

/// Inputs of an axis at a time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Given {
    pub(crate) time_s: f64,
    pub(crate) motion: Motion,
    pub(crate) load_n: f64,
}

impl Given {
    /// Interpolates towards later inputs, at a share of the way.
    pub(in crate::plants) fn towards(&self, later: &Self, share: f64) -> Self {
        let step_s = later.time_s - self.time_s;
        Self {
            time_s: self.time_s + share * step_s,
            motion: self.motion.towards(&later.motion, step_s, share),
            load_n: self.load_n + share * (later.load_n - self.load_n),
        }
    }
}
