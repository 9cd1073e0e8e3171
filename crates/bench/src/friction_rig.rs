//! A single driven axis with given motion and a measured effort: the friction rig, or a linear axis.
//!
//! `effort = load_gain * load + inertia * acceleration + friction`, where friction opposes the motion:
//! `(coulomb_effort +- asymmetry/2 + (load_coefficient + mu) |load| radius) tanh(v/v_r) + viscous_effort * speed`.
//! The effort is the drive's, so friction adds to it while the axis moves forward.
//!
//! `mu` is the coefficient of the rubbing pair under `[surface]`, dry, sliding speed `v` in m/s, load `N` in N, mean pressure `p`
//! in MPa on 140 mm x 140 mm:
//!
//! * Babbitt: `.14 + .08 exp(-v/.010) (1 + .15 (N - 100e3)/100e3)`: falls with speed, the more the higher the load.
//! * plastic: `.08 (p/5)^-.15 + 6 (v - .0035)` from 3.5 mm/s to the 7.4 mm/s of the rig's range; flat up to 20 mm/s, then
//!   `.25 (v - .020)`.
//!
//! It follows the speed with a lag (frictional memory), and a rest raises it: the excess grows towards
//! `break_away_ratio - 1` over `break_away_time_s` at rest and is lost over `break_away_distance_m` of sliding. These are
//! assumptions in the shape of published curves; the anchors lie within a factor of two of them. Without `[surface]` the
//! effort is a function of motion and load alone, unless an effect remembers. What effects add: [`crate::effects`]; sliding
//! speeds are taken at the friction radius.

use crate::description::{BearingMaterial, FrictionRig, Surface, ripples};
use crate::extended_friction::smooth_step;
use crate::motion::Motion;

/// Area that the load rests on, m2.
const AREA_M2: f64 = 0.14 * 0.14;
/// Fastest sliding of the rig's own tests: 6 deg/s at a radius of 70 mm, rounded up.
const RIG_SPEED_M_S: f64 = 0.0074;
/// Speed below which a pair is at rest.
const REST_M_S: f64 = 1e-5;
/// Smallest pressure in MPa that the plastic's power law is taken at.
const LEAST_PRESSURE_MPA: f64 = 0.01;
/// Longest step of the memory of a rest, s.
const MEMORY_STEP_S: f64 = 1e-3;
/// The same where bristles bend: over micrometres, about the reversal.
const BRISTLE_STEP_S: f64 = 2.5e-4;
/// Widths beyond which the sign is 1 to a rounding.
const SURE_WIDTHS: f64 = 20.0;
/// Bending lengths beyond which nothing is left of how bristles were bent.
const SURE_BENDS: f64 = 40.0;
/// What rounding may add to a count of steps.
const WHOLE_STEP: f64 = 1e-6;

/// Effort of the drive and its friction share, in N or N m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Whole effort.
    pub effort: f64,
    /// Friction share, positive while it opposes forward motion.
    pub friction: f64,
}

/// What friction of an axis remembers.
#[derive(Clone, Copy, Debug, Default)]
struct AxisMemory {
    /// Excess of the rubbing pair's static friction.
    excess: f64,
    /// Turned sign of pre-sliding.
    turned: f64,
    /// Share of the excess that a rest has built up.
    rest: f64,
    /// Temperature rise in K.
    rise_k: f64,
}

/// The axis at one time: motion, load with its ripples, coefficient of the rubbing pair.
struct Moment {
    time_s: f64,
    motion: Motion,
    load_n: f64,
    coefficient: f64,
}

/// The sign of a sliding speed, as wide as the description says.
///
/// `tanh` through one exponential: right to a rounding of 1, which is what friction needs, and not of a tiny result, which the library's pays for.
fn sign(rig: &FrictionRig, sliding_m_s: f64) -> f64 {
    let widths = sliding_m_s / rig.axis.regularisation_m_s;
    let fallen = (-2.0 * widths.abs().min(SURE_WIDTHS)).exp();
    ((1.0 - fallen) / (1.0 + fallen)).copysign(widths)
}

/// The friction at a moment.
fn friction_at(rig: &FrictionRig, now: &Moment, memory: &AxisMemory) -> f64 {
    let (axis, extension) = (&rig.axis, &rig.extension);
    let speed = now.motion.rate * axis.friction_radius_m;
    let sign = sign(rig, speed);
    let load_dependent =
        (axis.load_coefficient + now.coefficient) * now.load_n.abs() * axis.friction_radius_m;
    let mut dry = axis.coulomb_effort + load_dependent;
    for term in &extension.stribeck {
        dry += term.rise * (-speed.abs() / term.speed_m_s).exp();
    }
    if let Some(term) = &extension.breakaway {
        dry += term.excess * memory.rest;
    }
    for term in &extension.friction_steps {
        dry += term.change * smooth_step(now.time_s, term.time_s);
    }
    if let Some(term) = &extension.thermal {
        dry *= term.level(memory.rise_k);
    }
    let turned = if extension.presliding_distance_m > 0.0 { memory.turned } else { sign };
    dry * turned
        + 0.5 * axis.coulomb_asymmetry * sign * sign
        + axis.viscous_effort * now.motion.rate
        + extension.viscous_asymmetry * now.motion.rate * sign
}

/// The effort at a moment.
fn effort_at(rig: &FrictionRig, now: &Moment, memory: &AxisMemory) -> Effort {
    let axis = &rig.axis;
    let friction = friction_at(rig, now, memory);
    let ripple = ripples(&rig.extension.position_ripples, now.motion.value);
    Effort {
        effort: axis.load_gain * now.load_n + axis.inertia * now.motion.acceleration + friction + ripple,
        friction,
    }
}

/// The memory after a step at a moment that stands for it.
fn remembered(rig: &FrictionRig, now: &Moment, last: AxisMemory, step_s: f64) -> AxisMemory {
    let (axis, extension) = (&rig.axis, &rig.extension);
    let speed = now.motion.rate * axis.friction_radius_m;
    let sliding = speed.abs();
    let mut next = last;
    if let Some(surface) = &rig.surface {
        next.excess = surface.remember(last.excess, sliding, step_s);
    }
    if let Some(term) = &extension.breakaway {
        let (steady, rate) = term.steady(sliding);
        next.rest = steady + (last.rest - steady) * (-rate * step_s).exp();
    }
    if let Some(term) = &extension.thermal {
        let heat = (friction_at(rig, now, &last) * now.motion.rate).max(0.0);
        let steady = term.resistance_k_w * heat;
        next.rise_k = steady + (last.rise_k - steady) * (-step_s / term.time_constant_s).exp();
    }
    next
}

/// A sliding speed and its sign.
#[derive(Clone, Copy)]
struct Sliding {
    speed_m_s: f64,
    sign: f64,
}

/// The turned sign of pre-sliding behind a step from one sliding to another, over which the sign moves evenly. As the distance goes to 0
/// it becomes the sign at the step's end.
fn turned(distance_m: f64, last: f64, [begin, end]: [Sliding; 2], step_s: f64) -> f64 {
    let (from, to) = (begin.speed_m_s, end.speed_m_s);
    // Mean of the magnitude of a speed that changes evenly.
    let mean = if from * to < 0.0 {
        0.5 * (from * from + to * to) / (from - to).abs()
    } else {
        0.5 * (from + to).abs()
    };
    let bends = mean * step_s / distance_m;
    let gone = -(-bends.min(SURE_BENDS)).exp_m1();
    let behind = if bends > 1e-6 { gone / bends } else { 1.0 - 0.5 * bends };
    end.sign + (last - begin.sign) * (1.0 - gone) - (end.sign - begin.sign) * behind
}

/// What drives an axis at a time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Given {
    pub(crate) time_s: f64,
    pub(crate) motion: Motion,
    pub(crate) load_n: f64,
}

impl Given {
    /// A share of the way to a later one.
    fn towards(&self, later: &Self, share: f64) -> Self {
        let step_s = later.time_s - self.time_s;
        Self {
            time_s: self.time_s + share * step_s,
            motion: self.motion.towards(&later.motion, step_s, share),
            load_n: self.load_n + share * (later.load_n - self.load_n),
        }
    }
}

/// The efforts at ascending times under a motion and a load. Memory is marched from one of the times to the next along what is given
/// there: they have to be as near to each other as a log's samples.
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

/// The efforts at the first of every `every` places of a course with ascending times, whose motion is also known at other times.
///
/// Memory is marched through all places, so that an effort does not depend on `every`.
pub(crate) fn efforts_along(
    rig: &FrictionRig,
    course: &[Given],
    every: usize,
    motion: impl Fn(f64) -> Motion,
) -> Vec<Effort> {
    let Some(first) = course.first() else { return Vec::new() };
    let extension = &rig.extension;
    let lag_s = extension.drive_lag_s;
    let motion = |t: f64| motion(t - lag_s);
    let lagged = |given: &Given| match lag_s {
        0.0 => *given,
        _ => Given { motion: motion(given.time_s), ..*given },
    };
    let moment = |given: &Given| {
        let load_n = given.load_n + ripples(&extension.load_ripples, given.time_s);
        let slid = |s: &Surface| {
            let then = motion((given.time_s - s.lag_s).max(first.time_s));
            coefficient(s.material, (then.rate * rig.axis.friction_radius_m).abs(), load_n)
        };
        let coefficient = rig.surface.as_ref().map_or(0.0, slid);
        Moment { time_s: given.time_s, motion: given.motion, load_n, coefficient }
    };
    let sliding = |motion: &Motion| {
        let speed_m_s = motion.rate * rig.axis.friction_radius_m;
        Sliding { speed_m_s, sign: sign(rig, speed_m_s) }
    };
    let distance_m = extension.presliding_distance_m;
    let bends = distance_m > 0.0;
    let remembers = rig.surface.is_some() || extension.breakaway.is_some() || extension.thermal.is_some();
    let mut last = lagged(first);
    let mut slides = sliding(&last.motion);
    // Who looks at an axis in motion finds its bristles bent that way, and as old as this speed leaves them; at rest it has rested.
    let mut memory = AxisMemory {
        turned: slides.sign,
        rest: extension.breakaway.as_ref().map_or(0.0, |term| term.steady(slides.speed_m_s).0),
        rise_k: extension.temperature_start_k,
        ..AxisMemory::default()
    };
    let mut efforts = Vec::with_capacity(course.len().div_ceil(every));
    for (place, given) in course.iter().enumerate() {
        let is_asked = place % every == 0;
        if !is_asked && !remembers && !bends {
            continue;
        }
        let given = lagged(given);
        if remembers || bends {
            // The memory is marched in steps that follow the speed.
            let longest = if bends { BRISTLE_STEP_S } else { MEMORY_STEP_S };
            let steps = ((given.time_s - last.time_s) / longest - WHOLE_STEP).ceil().max(1.0);
            let step = (given.time_s - last.time_s) / steps;
            for k in 0..steps as usize {
                if remembers {
                    let mut middle = moment(&last.towards(&given, (k as f64 + 0.5) / steps));
                    middle.coefficient *= 1.0 + memory.excess;
                    memory = remembered(rig, &middle, memory, step);
                }
                if bends {
                    let there = sliding(&last.towards(&given, (k as f64 + 1.0) / steps).motion);
                    memory.turned = turned(distance_m, memory.turned, [slides, there], step);
                    slides = there;
                }
            }
            last = given;
        }
        if is_asked {
            let mut now = moment(&given);
            now.coefficient *= 1.0 + memory.excess;
            efforts.push(effort_at(rig, &now, &memory));
        }
    }
    efforts
}

/// Coefficient of a dry pair at a sliding speed in m/s (not negative) and a load in N.
pub fn coefficient(material: BearingMaterial, sliding_m_s: f64, load_n: f64) -> f64 {
    let load = load_n.abs();
    match material {
        BearingMaterial::Babbitt => {
            0.14 + 0.08 * (-sliding_m_s / 0.010).exp() * (1.0 + 0.15 * (load - 100e3) / 100e3)
        }
        BearingMaterial::Plastic => {
            let pressure = (load / AREA_M2 * 1e-6).max(LEAST_PRESSURE_MPA);
            0.08 * (pressure / 5.0).powf(-0.15)
                + 6.0 * (sliding_m_s.min(RIG_SPEED_M_S) - 0.0035).max(0.0)
                + 0.25 * (sliding_m_s - 0.020).max(0.0)
        }
    }
}

impl Surface {
    /// The excess of static friction after a step at a sliding speed.
    fn remember(&self, excess: f64, sliding_m_s: f64, step_s: f64) -> f64 {
        let full = self.break_away_ratio - 1.0;
        if sliding_m_s < REST_M_S {
            full + (excess - full) * (-step_s / self.break_away_time_s).exp()
        } else {
            excess * (-sliding_m_s * step_s / self.break_away_distance_m).exp()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Bench;
    use crate::description::BreakawayTerm;
    use crate::motion::Profile;

    fn rig(name: &str) -> FrictionRig {
        let Bench::FrictionRig(rig) = Bench::open(name).unwrap() else { panic!("{name}") };
        *rig
    }

    #[test]
    fn babbitt_falls_with_speed_and_more_at_load_while_plastic_rises() {
        use BearingMaterial::{Babbitt, Plastic};
        let drop = |load| coefficient(Babbitt, 0.0, load) - coefficient(Babbitt, 0.0073, load);
        assert!(drop(240e3) > 1.15 * drop(100e3) && drop(100e3) > 0.04);
        assert!((coefficient(Babbitt, 0.0, 100e3) - 0.22).abs() < 1e-15);
        assert_eq!(coefficient(Plastic, 0.001, 100e3), coefficient(Plastic, 0.003, 100e3));
        assert!((coefficient(Plastic, 0.0055, 98e3) - 0.08 - 6.0 * 0.002).abs() < 1e-12);
        assert!(coefficient(Plastic, 0.006, 240e3) < coefficient(Plastic, 0.006, 100e3));
        // A higher torque with Babbitt at every speed and load of the rig.
        for load in [100e3, 150e3, 200e3, 240e3] {
            for speed in [0.0, 0.002, 0.005, 0.0073] {
                assert!(coefficient(Babbitt, speed, load) > coefficient(Plastic, speed, load));
            }
        }
    }

    #[test]
    fn a_rest_raises_break_away_and_the_lag_opens_a_loop() {
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
        // Well into the sliding only the lag is left: more friction while speeding up, less while slowing down, by
        // `lag * dmu/dv * dv/dt * N R` = 0.92 N m 7 s after the start.
        let difference = |t: usize| with[t].friction - without[t].friction;
        assert!((difference(12_000) - 0.92).abs() < 0.02, "{}", difference(12_000));
        assert!(difference(20_000) < -1.0, "{}", difference(20_000));
        // The other direction is the mirror image.
        assert!((with[12_000].friction + with[37_000].friction).abs() < 1e-3 * with[12_000].friction);
    }

    #[test]
    fn pre_sliding_over_no_distance_is_none_and_grows_evenly_with_a_short_one() {
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
        // Steps of a tenth of the length give the same: samples so close that they are the steps.
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
    fn the_sign_is_tanh() {
        let rig = rig("friction-rig");
        for i in -4000..=4000 {
            let widths = 1e-2 * f64::from(i);
            let off = sign(&rig, widths * rig.axis.regularisation_m_s) - widths.tanh();
            assert!(off.abs() < 3e-16, "{widths}: {off}");
        }
    }

    #[test]
    fn efforts_at_some_places_of_a_course_are_those_at_all_of_them() {
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
    fn static_friction_is_as_old_at_the_start_as_the_speed_leaves_it() {
        // At .014 m/s an age of 1 / (1 + .5 s * .014 m/s / 7 mm), a half.
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
    fn without_a_surface_the_effort_is_a_function_of_the_moment() {
        let rig = rig("friction-rig");
        let motion = Motion { value: 0.0, rate: 0.1, acceleration: 0.02 };
        let all = efforts(&rig, &[0.0, 1.0], |_| motion, |_| 1e5);
        assert_eq!(all[0], all[1]);
        assert!((all[0].friction - 0.14 * 1e5 * 0.07).abs() < 1e-9);
        assert!((all[0].effort - all[0].friction - 5.0 * 0.02).abs() < 1e-9);
    }
}
