//! Coupling with play and elasticity between the drive of an axis and its rubbing part.
//!
//! The coupling is deflected by `u = x - y`, with the drive at `x` and the rubbing part at `y`. Its
//! effort `f(u)` is 0 while `|u| <= g/2`, and `(|u| - g/2)/c` in the direction of `u` beyond; `g`
//! is the play and `c` the compliance. With `c = 0` the effort at the ends of the play is any
//! effort in that direction. The rubbing part has no inertia, so `F(y') = f(u)` with its friction
//! `F`. This is a play operator (Visintin, Differential Models of Hysteresis, 1994, III.2) in
//! series with a spring.
//!
//! A step of `h` takes the speed `V` of the drive in its middle and is implicit: `u_1 = u_0 + h (V
//! - v)` and `F(v) = f(u_1)`. One equation with one unknown `v` remains. It has one solution if `F`
//! rises with `v`. Friction that falls with speed may have several, of which one results. A part
//! with friction does not overshoot the play, and its bristles move it by their length at most:
//! these limits keep the result finite where friction is negative. As `g` and `c` go to 0, `v`
//! becomes `V`. Units: those of the motion (m or rad) and of the effort (N or N m).

use crate::description::Axis;

/// Maximum number of trial speeds.
const MAX_TRIALS: usize = 80;
/// Number of trial speeds after which every second one bisects the bracket.
const MAX_SECANTS: usize = 8;
/// Error of the effort, as a share of the largest effort in the bracket.
const TOLERANCE: f64 = 1e-10;

/// Coupling of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Coupling {
    /// Half the play, m or rad.
    half_play: f64,
    /// Compliance, m/N or rad/(N m).
    compliance: f64,
}

/// Step of the drive.
pub(super) struct DriveStep {
    /// Deflection of the coupling before the step, m or rad.
    pub(super) deflection: f64,
    /// Speed of the drive, m/s or rad/s.
    pub(super) rate: f64,
    /// Length, s; positive.
    pub(super) step_s: f64,
    /// Distance by which bristles move the part against the coupling, m or rad.
    pub(super) bristles: f64,
}

impl Coupling {
    /// Coupling of an axis; none without play and compliance.
    pub(super) fn new(axis: &Axis) -> Option<Self> {
        // A calibration may try negative values.
        let half_play = (0.5 * axis.play / axis.friction_radius_m).max(0.0);
        let coupling = Self { half_play, compliance: axis.coupling_compliance.max(0.0) };
        (half_play > 0.0 || coupling.compliance > 0.0).then_some(coupling)
    }

    /// Deflection in steady sliding under a friction, with the regularised sign of the speed.
    pub(super) fn deflection(&self, sign: f64, friction: f64) -> f64 {
        self.half_play * sign + self.compliance * friction
    }

    /// Deflection that the coupling can have: a rigid one has no more than its play.
    pub(super) fn limited(&self, deflection: f64) -> f64 {
        if self.compliance > 0.0 { deflection } else { deflection.max(-self.half_play).min(self.half_play) }
    }

    /// Speed of the rubbing part over a step of the drive, under its friction at a speed.
    ///
    /// `guess` is a speed near the result, and `probe` a small difference of speeds.
    pub(super) fn speed(
        &self,
        drive: &DriveStep,
        [guess, probe]: [f64; 2],
        friction: impl Fn(f64) -> f64,
    ) -> f64 {
        let step_s = drive.step_s;
        // Speeds that leave the coupling at the ends of its play.
        let free = drive.deflection / step_s + drive.rate;
        let (slow, fast) = (free - self.half_play / step_s, free + self.half_play / step_s);
        let search = |tolerance: f64| Search { guess, probe, tolerance };
        // Without bristles a part within its play is at standstill, without friction.
        let (forwards, backwards) = if drive.bristles == 0.0 {
            (slow > 0.0, fast < 0.0)
        } else {
            let (at_slow, at_fast) = (friction(slow), friction(fast));
            if at_slow <= 0.0 && at_fast >= 0.0 {
                return search(TOLERANCE * at_slow.abs().max(at_fast)).root([slow, fast], friction);
            }
            (at_slow > 0.0, at_fast < 0.0)
        };
        let edge = match (forwards, backwards) {
            (true, _) => slow,
            (_, true) => fast,
            _ => return slow.max(0.0).min(fast),
        };
        if self.compliance == 0.0 {
            return edge;
        }
        let stiffness = step_s / self.compliance;
        let back = drive.bristles / step_s;
        let bracket = if forwards { [slow.min(0.0) - back, slow] } else { [fast, fast.max(0.0) + back] };
        let scale = stiffness * edge.abs().max(back);
        search(TOLERANCE * scale).root(bracket, |speed| friction(speed) - stiffness * (edge - speed))
    }
}

/// Search for the zero of a rising function.
struct Search {
    guess: f64,
    probe: f64,
    tolerance: f64,
}

impl Search {
    /// Zero between two arguments by secants within a shrinking bracket; an end without a zero.
    fn root(&self, [mut low, mut high]: [f64; 2], function: impl Fn(f64) -> f64) -> f64 {
        let mut next = self.guess;
        let mut before: Option<(f64, f64)> = None;
        for trial in 0..MAX_TRIALS {
            if trial == MAX_SECANTS {
                if function(high) <= 0.0 {
                    return high;
                }
                if function(low) >= 0.0 {
                    return low;
                }
            }
            let bisects = trial >= MAX_SECANTS && trial % 2 == 0;
            if bisects || !(low < next && next < high) {
                next = 0.5 * (low + high);
            }
            let value = function(next);
            if value.abs() <= self.tolerance || next <= low || next >= high {
                return next;
            }
            if value < 0.0 {
                low = next;
            } else {
                high = next;
            }
            let (x, y) = before.unwrap_or_else(|| (next + self.probe, function(next + self.probe)));
            before = Some((next, value));
            next -= value * (next - x) / (value - y);
        }
        next.max(low).min(high)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Effort, Given, efforts, efforts_along};
    use crate::description::{Bench, BreakawayTerm, FrictionRig, StribeckTerm, ThermalTerm};
    use crate::signals::{Motion, Profile};
    use proptest::prelude::*;

    /// Speed of the triangular motion, m/s or rad/s.
    const SPEED: f64 = 0.1;
    /// Its period, s.
    const PERIOD_S: f64 = 0.8;
    /// Dry friction, N.
    const LEVEL: f64 = 100.0;

    /// Axis with 100 N of dry friction, and a sharp sign.
    fn axis(play: f64, coupling_compliance: f64) -> FrictionRig {
        let text = include_str!("../../../../../examples/friction-damper.toml");
        let Bench::FrictionRig(mut rig) = Bench::parse("damper", text).unwrap() else { panic!() };
        rig.axis.coulomb_effort = LEVEL;
        rig.axis.regularisation_m_s = 1e-6;
        (rig.axis.play, rig.axis.coupling_compliance) = (play, coupling_compliance);
        *rig
    }

    /// Motion at constant speed that reverses at the middle and at the end of each period.
    fn triangle(time_s: f64) -> Motion {
        let within = time_s.rem_euclid(PERIOD_S);
        let forwards = within < 0.5 * PERIOD_S;
        let value = SPEED * if forwards { within } else { PERIOD_S - within };
        Motion { value, rate: if forwards { SPEED } else { -SPEED }, acceleration: 0.0 }
    }

    /// Friction over the distance since the second reversal of the triangle, one value each 0.1 ms.
    fn after_reversal(rig: &FrictionRig) -> impl Fn(f64) -> f64 + use<> {
        // The reversal lies between two places.
        let times: Vec<f64> = (0..12_000).map(|i| 1e-4 * (f64::from(i) + 0.5)).collect();
        let efforts = efforts(rig, &times, triangle, |_| 0.0);
        move |distance| efforts[((PERIOD_S + distance / SPEED) / 1e-4) as usize].friction
    }

    /// Distance that the drive makes in a step of the test, m.
    const STEP_M: f64 = 1e-4 * SPEED;

    #[test]
    fn friction_is_absent_over_exactly_the_play() {
        for play in [2e-3, 7.3e-3] {
            let friction = after_reversal(&axis(play, 0.0));
            assert!((friction(-2.0 * STEP_M) + LEVEL).abs() < 1e-9);
            for share in [0.05, 0.5, 0.95] {
                assert!(friction(share * play).abs() < 1e-9, "{share}: {}", friction(share * play));
            }
            assert!(friction(play - 2.0 * STEP_M).abs() < 1e-9);
            assert!((friction(play + 2.0 * STEP_M) - LEVEL).abs() < 1e-9);
        }
    }

    #[test]
    fn an_elastic_coupling_has_its_slope_until_dry_friction_is_reached() {
        let compliance = 2e-5;
        let friction = after_reversal(&axis(0.0, compliance));
        for distance in [5e-4, 1e-3, 2e-3, 3e-3, 3.9e-3] {
            let expected = -LEVEL + distance / compliance;
            assert!((friction(distance) - expected).abs() < 0.01 * LEVEL, "{}", friction(distance));
        }
        assert!((friction(4.1e-3) - LEVEL).abs() < 1e-6 * LEVEL);
    }

    #[test]
    fn a_coupling_with_play_releases_crosses_and_loads() {
        let (play, compliance) = (3e-3, 2e-5);
        let friction = after_reversal(&axis(play, compliance));
        for (distance, expected) in
            [(1e-3, -50.0), (2.1e-3, 0.0), (3.5e-3, 0.0), (4.9e-3, 0.0), (6e-3, 50.0), (7.1e-3, LEVEL)]
        {
            assert!(
                (friction(distance) - expected).abs() < 0.01 * LEVEL,
                "{distance}: {}",
                friction(distance)
            );
        }
    }

    #[test]
    fn play_is_a_distance_at_the_friction_radius_and_compliance_an_angle() {
        let mut rig = axis(0.7e-3, 0.0);
        rig.axis.friction_radius_m = 0.07;
        let friction = after_reversal(&rig);
        assert!(friction(0.0099).abs() < 1e-9 && (friction(0.0101) - LEVEL).abs() < 1e-9);
        (rig.axis.play, rig.axis.coupling_compliance) = (0.0, 5e-5);
        let friction = after_reversal(&rig);
        assert!((friction(2.5e-3) + 50.0).abs() < 1.0 && friction(5e-3).abs() < 1.0);
    }

    /// Sine whose rate is exact.
    fn sine(time_s: f64) -> Motion {
        let (s, c) = (5.0 * time_s).sin_cos();
        Motion { value: 0.02 * s, rate: 0.1 * c, acceleration: -0.5 * s }
    }

    /// Axis with every memory, and friction that depends on speed and position.
    fn full(play: f64, coupling_compliance: f64) -> FrictionRig {
        let mut rig = axis(play, coupling_compliance);
        rig.axis.regularisation_m_s = 2e-3;
        rig.axis.viscous_effort = 200.0;
        rig.extension.friction_slope = 300.0;
        rig.extension.presliding_distance_m = 1e-4;
        rig.extension.breakaway = Some(BreakawayTerm { excess: 30.0, rest_time_s: 0.1, distance_m: 2e-3 });
        rig.extension.thermal =
            Some(ThermalTerm { level_per_k: -0.01, resistance_k_w: 1.0, time_constant_s: 1.0 });
        rig
    }

    fn run(rig: &FrictionRig, interval_s: f64) -> Vec<Effort> {
        let times: Vec<f64> =
            (0..=(4.0 / interval_s).round() as usize).map(|i| interval_s * i as f64).collect();
        efforts(rig, &times, sine, |_| 0.0)
    }

    /// Largest and mean difference of friction, relative to its largest value.
    fn difference(a: impl Iterator<Item = Effort>, b: &[Effort]) -> (f64, f64) {
        let level = b.iter().fold(0.0_f64, |max, e| max.max(e.friction.abs()));
        let off: Vec<f64> = a.zip(b).map(|(a, b)| (a.friction - b.friction).abs() / level).collect();
        (off.iter().copied().fold(0.0, f64::max), off.iter().sum::<f64>() / off.len() as f64)
    }

    #[test]
    fn a_coupling_vanishes_with_its_size() {
        for plain in [axis(0.0, 0.0), full(0.0, 0.0)] {
            let mut plain = plain;
            plain.axis.regularisation_m_s = 2e-3;
            // Steps of the memories and of the coupling are the same here.
            let without = run(&plain, 2.5e-4);
            for (play, compliance) in [(1e-12, 0.0), (0.0, 1e-14), (1e-12, 1e-14)] {
                let mut with = plain.clone();
                (with.axis.play, with.axis.coupling_compliance) = (play, compliance);
                let (largest, _) = difference(run(&with, 2.5e-4).into_iter(), &without);
                assert!(largest < 2e-4, "{play} {compliance}: {largest}");
            }
        }
    }

    #[test]
    fn the_sampling_of_a_log_has_no_influence() {
        // 0.25 ms and more are cut into the same steps; 25 us are a tenth of them.
        for (rig, allowed) in [
            (full(2e-3, 0.0), (f64::INFINITY, 1e-3)),
            (full(0.0, 2e-5), (0.02, 1e-3)),
            (full(2e-3, 2e-5), (0.02, 1e-3)),
        ] {
            let coarse = run(&rig, 2e-3);
            for interval_s in [1e-3, 2.5e-4, 2.5e-5] {
                let every = (2e-3_f64 / interval_s).round() as usize;
                let (largest, mean) = difference(run(&rig, interval_s).into_iter().step_by(every), &coarse);
                assert!(largest <= allowed.0 && mean < allowed.1, "{interval_s}: {largest} {mean}");
            }
        }
    }

    #[test]
    fn long_steps_while_sliding_do_not_change_the_friction() {
        for (play, compliance) in [(2e-3, 0.0), (0.0, 2e-5), (2e-3, 2e-5)] {
            let mut rig = axis(play, compliance);
            (rig.axis.regularisation_m_s, rig.axis.viscous_effort) = (2e-3, 200.0);
            let fine = run(&rig, 2.5e-4).into_iter().step_by(40);
            let (largest, mean) = difference(fine, &run(&rig, 1e-2));
            assert!(largest < 1e-2 && mean < 2e-4, "{play} {compliance}: {largest} {mean}");
        }
    }

    #[test]
    fn efforts_do_not_depend_on_the_places_that_are_read() {
        let given = |i: i32| {
            let time_s = 1e-3 * f64::from(i);
            Given { time_s, motion: sine(time_s), load_n: 0.0 }
        };
        let course: Vec<Given> = (0..2001).map(given).collect();
        let mut rig = full(2e-3, 2e-5);
        for lag_s in [0.0, 3.3e-3] {
            rig.extension.drive_lag_s = lag_s;
            let all: Vec<Effort> = efforts_along(&rig, &course, 1, sine).into_iter().step_by(4).collect();
            assert_eq!(efforts_along(&rig, &course, 4, sine), all);
        }
    }

    #[test]
    fn inertia_and_spring_stay_at_the_drive() {
        let mut rig = axis(2e-3, 1e-5);
        let without = run(&rig, 1e-3);
        (rig.axis.inertia, rig.axis.spring_stiffness, rig.axis.neutral_position) = (3.0, 500.0, 0.01);
        for ((with, without), i) in run(&rig, 1e-3).iter().zip(&without).zip(0..) {
            let motion = sine(1e-3 * f64::from(i));
            let more = 3.0 * motion.acceleration + 500.0 * (motion.value - 0.01);
            assert!((with.effort - without.effort - more).abs() < 1e-9 && with.friction == without.friction);
        }
    }

    #[test]
    fn a_drive_that_stays_within_its_play_has_no_friction() {
        let drive = Profile::Cycles { stroke: 1e-3, period_s: 1.0, cycles: 3.0 };
        let times: Vec<f64> = (0..3000).map(|i| 1e-3 * f64::from(i)).collect();
        let efforts = efforts(&axis(2.1e-3, 0.0), &times, |t| drive.at(t), |_| 0.0);
        assert!(efforts.iter().all(|e| e.friction == 0.0));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(256))]
        /// Checks that the effort is finite at any play and compliance, also with negative friction
        /// and with friction that falls steeply.
        #[test]
        fn efforts_are_finite(
            (play, compliance) in (-12.0..3.0_f64, -15.0..6.0_f64),
            (level, slope, rise) in (-1e3..1e4_f64, -1e5..1e5_f64, -1e3..1e4_f64),
            (viscous, asymmetry) in (-1e6..1e6_f64, -1e6..1e6_f64),
            (width, radius, interval) in (-9.0..0.0_f64, -6.0..3.0_f64, -6.0..-1.0_f64),
            which in 0..8_u8,
        ) {
            let mut rig = full(0.0, 0.0);
            if which & 1 == 0 {
                rig.axis.play = 10_f64.powf(play);
            }
            if which & 2 == 0 {
                rig.axis.coupling_compliance = 10_f64.powf(compliance);
            }
            if which & 4 == 0 {
                rig.extension.presliding_distance_m = 0.0;
            }
            rig.axis.coulomb_effort = level;
            rig.axis.viscous_effort = viscous;
            rig.extension.viscous_asymmetry = asymmetry;
            rig.extension.friction_slope = slope;
            rig.extension.stribeck.push(StribeckTerm { rise, speed_m_s: 0.02 });
            rig.axis.regularisation_m_s = 10_f64.powf(width);
            rig.axis.friction_radius_m = 10_f64.powf(radius);
            let interval_s = 10_f64.powf(interval);
            let times: Vec<f64> = (0..200).map(|i| interval_s * f64::from(i)).collect();
            let all = efforts(&rig, &times, sine, |_| 10.0);
            prop_assert!(all.iter().all(|e| e.effort.is_finite() && e.friction.is_finite()), "{all:?}");
        }
    }
}
