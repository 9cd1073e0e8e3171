//! A single driven axis with given motion and a measured effort: the friction rig, or a linear
//! axis.
//!
//! `effort = load_gain * load + inertia * acceleration + constant_effort + spring_stiffness *
//! (position - neutral_position) + gravity_cos * cos(angle) + gravity_sin * sin(angle) + friction`,
//! where friction opposes the motion: `(coulomb_effort +- asymmetry/2 + (load_coefficient + mu)
//! |load| radius) tanh(v/v_r) + viscous_effort * speed`. The effort is the drive's, so friction
//! adds to it while the axis moves forward.
//!
//! `mu` is the coefficient of the rubbing pair of `[surface]` ([`rubbing_pair`]). Without it the
//! effort is a function of motion and load alone, unless an effect has a memory. Additional terms:
//! [`crate::effects`]; sliding speeds are taken at the friction radius.
//!
//! With `play` or `coupling_compliance` friction acts on a rubbing part that the drive moves
//! through a coupling ([`coupling`]). Speed and position in every friction term are then those of
//! this part. Only the lag of a surface's coefficient is taken on the drive's speed. Load, inertia,
//! spring and ripples act on the drive.

mod coupling;
mod rubbing_pair;
mod stepping;

pub use self::rubbing_pair::coefficient;
use self::stepping::Stepping;
pub(super) use self::stepping::{BRISTLE_STEP_S, STEP_ROUNDING};
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
pub(super) struct AxisMemory {
    /// Excess of the rubbing pair's static friction.
    pub(super) excess: f64,
    /// Pre-sliding sign, from -1 to 1.
    pub(super) turned: f64,
    /// Share of the excess that a standstill has built up.
    breakaway: f64,
    /// Temperature rise in K.
    rise_k: f64,
}

impl AxisMemory {
    /// Memory at the start. An axis that moves has its bristles bent that way, with the memory of
    /// this speed in steady sliding. An axis at standstill has been there for a long time.
    pub(super) fn of_steady_sliding(rig: &FrictionRig, slides: &Sliding) -> Self {
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
pub(super) struct Moment {
    pub(super) time_s: f64,
    pub(super) motion: Motion,
    pub(super) load_n: f64,
    pub(super) coefficient: f64,
}

/// Regularised sign of a sliding speed with the described width.
///
/// `tanh` through one exponential: exact to the rounding of 1, which is enough for friction. The
/// library's function is also exact for tiny results, and slower.
pub(super) fn sign(rig: &FrictionRig, sliding_m_s: f64) -> f64 {
    let widths = sliding_m_s / rig.axis.regularisation_m_s;
    let fallen = (-2.0 * widths.abs().min(SATURATION_WIDTHS)).exp();
    ((1.0 - fallen) / (1.0 + fallen)).copysign(widths)
}

/// Friction at a moment, under the motion of the rubbing part.
fn friction_at(rig: &FrictionRig, now: &Moment, rubbing: &Motion, memory: &AxisMemory) -> f64 {
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
pub(super) fn effort_at(rig: &FrictionRig, now: &Moment, rubbing: &Motion, memory: &AxisMemory) -> Effort {
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
pub(super) fn memory_after(
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
pub(super) struct Sliding {
    pub(super) speed_m_s: f64,
    pub(super) sign: f64,
}

impl Sliding {
    fn new(rig: &FrictionRig, motion: &Motion) -> Self {
        let speed_m_s = motion.rate * rig.axis.friction_radius_m;
        Self { speed_m_s, sign: sign(rig, speed_m_s) }
    }
}

/// Pre-sliding sign after a step from one sliding state to another, over which the sign changes
/// linearly. As the distance goes to 0 the result becomes the sign at the end of the step.
pub(super) fn presliding_sign(distance_m: f64, last: f64, [begin, end]: [Sliding; 2], step_s: f64) -> f64 {
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
    pub(super) fn towards(&self, later: &Self, share: f64) -> Self {
        let step_s = later.time_s - self.time_s;
        Self {
            time_s: self.time_s + share * step_s,
            motion: self.motion.towards(&later.motion, step_s, share),
            load_n: self.load_n + share * (later.load_n - self.load_n),
        }
    }
}

/// Efforts at ascending times under a motion and a load. Memory is integrated from one time to the
/// next along the values given there, so the times must be as close as a log's samples.
pub fn efforts(
    rig: &FrictionRig,
    times_s: &[f64],
    motion: impl Fn(f64) -> Motion,
    load_n: impl Fn(f64) -> f64,
) -> Vec<Effort> {
    let given = |&time_s: &f64| Given { time_s, motion: motion(time_s), load_n: load_n(time_s) };
    let course: Vec<Given> = times_s.iter().map(given).collect();
    efforts_along(rig, &course, 1, motion)
}

/// Efforts at every `every`-th place of a course with ascending times, whose motion is also known
/// between them.
///
/// Memory is integrated through all places, so that an effort does not depend on `every`.
pub(crate) fn efforts_along(
    rig: &FrictionRig,
    course: &[Given],
    every: usize,
    motion: impl Fn(f64) -> Motion,
) -> Vec<Effort> {
    let Some(first) = course.first() else { return Vec::new() };
    let lag_s = rig.extension.drive_lag_s;
    let motion = |t: f64| motion(t - lag_s);
    let lagged = |given: &Given| match lag_s {
        0.0 => *given,
        _ => Given { motion: motion(given.time_s), ..*given },
    };
    let mut stepping = Stepping::new(rig, first.time_s, lagged(first), motion);
    let mut efforts = Vec::with_capacity(course.len().div_ceil(every));
    for (place, given) in course.iter().enumerate() {
        let is_output = place % every == 0;
        if !is_output && !stepping.has_state() {
            continue;
        }
        let given = lagged(given);
        if stepping.has_state() {
            stepping.advance(&given);
        }
        if is_output {
            efforts.push(stepping.effort(&given));
        }
    }
    efforts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::{BreakawayTerm, StribeckTerm};
    use crate::signals::Profile;

    fn rig(name: &str) -> FrictionRig {
        FrictionRig::open(name).unwrap()
    }

    #[test]
    fn a_standstill_raises_break_away_and_the_lag_opens_a_loop() {
        let rig = rig("friction-rig-babbitt");
        let drive = Profile::Resting { stroke: 1.3334, period_s: 40.0, cycles: 1.0, dwell_s: 5.0 };
        let times: Vec<f64> = (0..50_000).map(|i| 1e-3 * f64::from(i)).collect();
        let run = |rig: &FrictionRig| efforts(rig, &times, |t| drive.at(t), |_| 100e3);
        let (with, mut without) = (run(&rig), rig.clone());
        if let Some(s) = &mut without.surface {
            (s.break_away_ratio, s.lag_s) = (1.0, 0.0);
        }
        let without = run(&without);
        let peak = |e: &[Effort]| e[5000..8000].iter().map(|e| e.friction).fold(0.0, f64::max);
        let ratio = peak(&with) / peak(&without);
        assert!((1.15..1.26).contains(&ratio), "{ratio}");
        // Well after the start only the lag remains: more friction during acceleration, less during
        // deceleration, by `lag * dmu/dv * dv/dt * N R` = 0.92 N m 7 s after the start.
        let difference = |t: usize| with[t].friction - without[t].friction;
        assert!((difference(12_000) - 0.92).abs() < 0.02, "{}", difference(12_000));
        assert!(difference(20_000) < -1.0, "{}", difference(20_000));
        // The other direction is the mirror image.
        assert!((with[12_000].friction + with[37_000].friction).abs() < 1e-3 * with[12_000].friction);
    }

    #[test]
    fn pre_sliding_vanishes_at_distance_0_and_grows_linearly_with_a_short_distance() {
        let (mut plain, drive) =
            (rig("friction-rig"), Profile::Cycles { stroke: 0.8, period_s: 4.0, cycles: 2.0 });
        plain.axis.regularisation_m_s = 6e-3;
        let motion = |t: f64| drive.at(t + 1.0);
        // From the middle of a stroke.
        let times: Vec<f64> = (0..1000).map(|i| 4e-3 * f64::from(i)).collect();
        let run = |distance_m: f64| {
            let mut rig = plain.clone();
            rig.extension.presliding_distance_m = distance_m;
            efforts(&rig, &times, motion, |_| 1e5)
        };
        let without = run(0.0);
        let change = |distance_m: f64| -> Vec<f64> {
            run(distance_m).iter().zip(&without).map(|(a, b)| a.friction - b.friction).collect()
        };
        let largest = |change: &[f64]| change.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
        let level = largest(&without.iter().map(|e| e.friction).collect::<Vec<_>>());
        assert!(largest(&change(1e-12)) < 1e-4 * level, "{}", largest(&change(1e-12)));
        assert!(largest(&change(1e-5)) > 5e-3 * level, "{}", largest(&change(1e-5)));
        // Steps of a tenth of the length give the same result; here the samples are so close that
        // they are the steps.
        let fine: Vec<f64> = (0..160_000).map(|i| 2.5e-5 * f64::from(i)).collect();
        let mut with = plain.clone();
        with.extension.presliding_distance_m = 3e-6;
        let fine = efforts(&with, &fine, motion, |_| 1e5);
        let coarse = run(3e-6);
        let off = coarse.iter().zip(fine.iter().step_by(160));
        let off: Vec<f64> = off.map(|(a, b)| a.friction - b.friction).collect();
        assert!(largest(&off) < 0.01 * largest(&change(3e-6)), "{}", largest(&off));
    }

    #[test]
    fn the_regularised_sign_is_tanh() {
        let rig = rig("friction-rig");
        for i in -4000..=4000 {
            let widths = 1e-2 * f64::from(i);
            let off = sign(&rig, widths * rig.axis.regularisation_m_s) - widths.tanh();
            assert!(off.abs() < 3e-16, "{widths}: {off}");
        }
    }

    #[test]
    fn efforts_do_not_depend_on_the_places_that_are_read() {
        let drive = Profile::Cycles { stroke: 0.8, period_s: 4.0, cycles: 2.0 };
        let given = |i: i32| {
            let time_s = 1e-3 * f64::from(i);
            Given { time_s, motion: drive.at(time_s), load_n: 1e5 + 100.0 * f64::from(i) }
        };
        let course: Vec<Given> = (0..4001).map(given).collect();
        let mut rig = rig("friction-rig-babbitt");
        rig.extension.presliding_distance_m = 3e-6;
        rig.extension.breakaway = Some(BreakawayTerm { excess: 400.0, rest_time_s: 0.5, distance_m: 7e-3 });
        for lag_s in [0.0, 3.3e-3] {
            rig.extension.drive_lag_s = lag_s;
            let at = |every| efforts_along(&rig, &course, every, |t| drive.at(t));
            let all: Vec<Effort> = at(1).into_iter().step_by(4).collect();
            assert_eq!(at(4), all);
        }
    }

    #[test]
    fn static_friction_starts_at_its_steady_value_for_the_speed() {
        // At 0.014 m/s the memory is 1 / (1 + 0.5 s * 0.014 m/s / 7 mm) = 0.5.
        let motion = Motion { value: 0.0, rate: -0.2, acceleration: 0.0 };
        let mut rig = rig("friction-rig");
        let run = |rig: &FrictionRig| efforts(rig, &[0.0, 1e-3, 1.0], |_| motion, |_| 1e5);
        let without = run(&rig);
        rig.extension.breakaway = Some(BreakawayTerm { excess: 400.0, rest_time_s: 0.5, distance_m: 7e-3 });
        let more = 200.0 * sign(&rig, -0.014);
        for (with, without) in run(&rig).iter().zip(&without) {
            assert!((with.friction - without.friction - more).abs() < 1e-9, "{with:?} {without:?}");
        }
    }

    #[test]
    fn stribeck_friction_of_an_axis_falls_exponentially_with_the_sliding_speed() {
        let friction = |rig: &FrictionRig, sliding_m_s: f64| {
            let rate = sliding_m_s / rig.axis.friction_radius_m;
            efforts(rig, &[0.0], |_| Motion { value: 0.0, rate, acceleration: 0.0 }, |_| 1e5)[0].friction
        };
        let plain = rig("friction-rig");
        let mut stribeck = plain.clone();
        stribeck.extension.stribeck.push(StribeckTerm { rise: 100.0, speed_m_s: 0.01 });
        // Multiples of the Stribeck speed; a Gaussian has the same value at 1 only.
        for (speeds, share) in [(0.5, 0.606_530_660), (1.0, 0.367_879_441), (2.0, 0.135_335_283)] {
            for speed in [0.01 * speeds, -0.01 * speeds] {
                let rise = friction(&stribeck, speed) - friction(&plain, speed);
                let expected = 100.0 * share * sign(&plain, speed);
                assert!((rise - expected).abs() < 1e-6, "{speed} m/s: {rise} for {expected}");
            }
        }
    }

    #[test]
    fn spring_and_sloping_friction_act_from_the_neutral_position() {
        let effort = |rig: &FrictionRig, value: f64, rate: f64| {
            efforts(rig, &[0.0], |_| Motion { value, rate, acceleration: 0.0 }, |_| 1e5)[0]
        };
        let plain = rig("friction-rig");
        let mut with = plain.clone();
        (with.axis.constant_effort, with.axis.spring_stiffness) = (7.0, 50.0);
        (with.axis.neutral_position, with.extension.friction_slope) = (0.2, 30.0);
        for (value, rate) in [(0.5, 0.4), (0.5, -0.4), (-0.1, 0.4)] {
            let (with, without) = (effort(&with, value, rate), effort(&plain, value, rate));
            let friction = with.friction - without.friction;
            assert!((friction - 30.0 * (value - 0.2) * rate.signum()).abs() < 1e-9, "{friction}");
            let more = with.effort - without.effort - friction;
            assert!((more - 7.0 - 50.0 * (value - 0.2)).abs() < 1e-9, "{more}");
        }
    }

    #[test]
    fn gravity_acts_with_the_cosine_and_the_sine_of_the_angle() {
        let effort = |rig: &FrictionRig, value: f64| {
            efforts(rig, &[0.0], |_| Motion { value, ..Motion::default() }, |_| 1e5)[0].effort
        };
        let plain = rig("friction-rig");
        let mut with = plain.clone();
        (with.axis.gravity_cos, with.axis.gravity_sin) = (-111.5, 0.8);
        for (angle, moment) in [(0.0, -111.5), (std::f64::consts::FRAC_PI_2, 0.8), (1e3_f64, -62.04)] {
            let more = effort(&with, angle) - effort(&plain, angle);
            assert!((more - moment).abs() < 0.01, "{angle}: {more}");
        }
    }

    #[test]
    fn without_a_surface_the_effort_is_a_function_of_the_moment() {
        let rig = rig("friction-rig");
        let motion = Motion { value: 0.0, rate: 0.1, acceleration: 0.02 };
        let all = efforts(&rig, &[0.0, 1.0], |_| motion, |_| 1e5);
        assert_eq!(all[0], all[1]);
        assert!((all[0].friction - 0.14 * 1e5 * 0.07).abs() < 1e-9);
        assert!((all[0].effort - all[0].friction - 5.0 * 0.02).abs() < 1e-9);
    }
}
