//! Driven axis, independent of the engine: the effort of a given motion, rotary or linear.
//!
//! The effort follows from the balance of an axis, `effort = gain F + m a + k x + friction +
//! ripple`, and from the documented meaning of each effect (`docs/effects.md`). The states of
//! friction (its delayed sign, the time at standstill, a temperature) obey linear equations. An
//! implicit second-order rule steps them by a quarter of a millisecond. The sign of the speed is a
//! logistic function; a step of friction is a ramp of 10 ms. Sensors are in `sensing`. Units: SI,
//! efforts in N or N m.

use super::hidden::{HiddenEffect, total};
use super::motion::{Load, Motion, Moved};
use super::sensing::Signals;
use std::f64::consts::TAU;

/// Step, s.
const STEP_S: f64 = 2.5e-4;
/// Length of the ramp of a step of friction, s.
const RAMP_S: f64 = 0.01;
/// Motion before the log begins, s.
const BEFORE_S: f64 = 0.2;

/// An axis with its true parameters.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RealAxis {
    /// True for a rotary axis.
    pub rotary: bool,
    /// Inertia, kg or kg m2.
    pub inertia: f64,
    /// Dry friction effort, N or N m.
    pub coulomb: f64,
    /// Viscous friction effort per speed.
    pub viscous: f64,
    /// Friction coefficient of the load.
    pub load_coefficient: f64,
    /// Share of the load that acts on the effort.
    pub load_gain: f64,
    /// Radius at which friction acts, m.
    pub radius_m: f64,
    /// Width of the friction sign, m/s.
    pub sign_width_m_s: f64,
    /// Temperature rise at the start of the log, relative to that of one second of sliding.
    pub warm: f64,
}

/// One record of an axis.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    /// Motion of the axis.
    pub motion: Motion,
    /// Load of the axis.
    pub load: Load,
    /// Time in the motion at which the log begins, s.
    pub phase_s: f64,
    /// Length, s.
    pub length_s: f64,
    /// First time stamp of the log, s.
    pub start_s: f64,
}

/// Linear memory `state' = rate (target - state)`.
#[derive(Clone, Copy, Default)]
struct Memory {
    state: f64,
}

impl Memory {
    /// `1/(1 + x + x^2/2)` replaces the exponential: stable for any rate.
    fn step(&mut self, rate: f64, target: f64) {
        let x = rate * STEP_S;
        self.state = target + (self.state - target) / (1.0 + x * (1.0 + 0.5 * x));
    }
}

/// Parameters of the added effects.
struct Added {
    stribeck: Option<(f64, f64)>,
    breakaway: Option<(f64, f64, f64)>,
    presliding_m: f64,
    thermal: Option<(f64, f64, f64)>,
    step: Option<(f64, f64)>,
    position_ripple: Option<(f64, f64, f64)>,
    load_ripple: Option<(f64, f64, f64)>,
    lag_s: f64,
    coulomb_asymmetry: f64,
    viscous_asymmetry: f64,
    spring: f64,
    /// Unbalanced moments at the angles 0 and a quarter of a turn, N m.
    gravity: [f64; 2],
    friction_slope: f64,
}

impl Added {
    fn new(hidden: &[HiddenEffect]) -> Self {
        let of = |name: &str| hidden.iter().find(|h| h.effect == name);
        let three = |name, [a, b, c]: [&str; 3]| of(name).map(|h| (h.get(a), h.get(b), h.get(c)));
        Self {
            stribeck: of("stribeck-friction").map(|h| (h.get("effort_rise"), h.get("speed_m_s"))),
            breakaway: three("breakaway", ["excess_effort", "rest_time_s", "distance_m"]),
            presliding_m: total(hidden, "presliding-hysteresis", "distance_m"),
            thermal: three("thermal-friction-drift", ["level_per_k", "resistance_k_w", "time_constant_s"]),
            step: of("friction-step").map(|h| (h.get("coulomb_effort"), h.get("time_s"))),
            position_ripple: three("position-ripple", ["cos_effort", "sin_effort", "period"]),
            load_ripple: three("load-ripple", ["cos_force_n", "sin_force_n", "frequency_hz"]),
            lag_s: total(hidden, "drive-lag", "lag_s"),
            coulomb_asymmetry: total(hidden, "coulomb-asymmetry", "asymmetry_effort"),
            viscous_asymmetry: total(hidden, "viscous-asymmetry", "asymmetry_effort"),
            spring: total(hidden, "spring-effort", "stiffness"),
            gravity: ["cos_effort", "sin_effort"].map(|p| total(hidden, "gravity-moment", p)),
            friction_slope: total(hidden, "position-friction", "friction_slope"),
        }
    }
}

fn wave((cosine, sine, period): (f64, f64, f64), at: f64) -> f64 {
    if period <= 0.0 {
        return 0.0;
    }
    let (s, c) = (TAU * at / period).sin_cos();
    cosine * c + sine * s
}

impl RealAxis {
    /// Returns the true signals of a record on an even grid.
    pub(crate) fn run(&self, run: &Run, hidden: &[HiddenEffect]) -> Signals {
        let axis = Self {
            inertia: self.inertia + total(hidden, "inertia-mismatch", "inertia_change"),
            coulomb: self.coulomb + total(hidden, "coulomb-level", "coulomb_effort"),
            viscous: self.viscous + total(hidden, "viscous-friction", "viscous_effort"),
            load_coefficient: self.load_coefficient
                + total(hidden, "load-dependent-friction", "load_coefficient"),
            load_gain: self.load_gain + total(hidden, "load-gain", "gain_change"),
            ..*self
        };
        let added = Added::new(hidden);
        let before = (BEFORE_S / STEP_S).round() as usize;
        let count = (run.length_s / STEP_S).round() as usize;
        let names = if self.rotary {
            (
                ["spindle_angle_rad", "spindle_speed_rad_s", "load_force_n"],
                ["drive_torque_nm", "friction_torque_nm"],
            )
        } else {
            (["position_m", "velocity_m_s", "load_force_n"], ["drive_force_n", ""])
        };
        let mut inputs = names.0.map(|n| (n, Vec::with_capacity(count)));
        let mut outputs = names.1.map(|n| (n, Vec::with_capacity(count)));
        let (mut turned, mut adhesion, mut warmth) =
            (Memory::default(), Memory::default(), Memory::default());
        warmth.state =
            self.warm * added.thermal.map_or(0.0, |t| t.1 * self.coulomb * run.motion.amplitude / t.2);
        for i in 0..before + count {
            let t = (i as f64 - before as f64) * STEP_S;
            let logged = run.motion.at(run.phase_s + t);
            let driven =
                if added.lag_s == 0.0 { logged } else { run.motion.at(run.phase_s + t - added.lag_s) };
            let load = run.load.at(t);
            let (effort, friction) =
                axis.effort(&added, run.start_s + t, driven, load, (&mut turned, &mut adhesion, &mut warmth));
            if i < before {
                continue;
            }
            for ((_, column), value) in inputs.iter_mut().zip([logged.place, logged.speed, load]) {
                column.push(value);
            }
            for ((_, column), value) in outputs.iter_mut().zip([effort, -friction]) {
                column.push(value);
            }
        }
        let outputs = outputs.into_iter().filter(|(name, _)| !name.is_empty()).collect();
        Signals { step_s: STEP_S, inputs: inputs.into(), outputs }
    }

    fn effort(
        &self,
        added: &Added,
        time_s: f64,
        driven: Moved,
        load_n: f64,
        (turned, adhesion, warmth): (&mut Memory, &mut Memory, &mut Memory),
    ) -> (f64, f64) {
        let slide = driven.speed * self.radius_m;
        let sign = 2.0 / (1.0 + (-2.0 * slide / self.sign_width_m_s).exp()) - 1.0;
        let load = load_n + added.load_ripple.map_or(0.0, |(c, s, f)| wave((c, s, 1.0 / f), time_s));
        let mut dry = self.coulomb + self.load_coefficient * load.abs() * self.radius_m;
        dry += added.friction_slope * driven.place;
        if let Some((rise, speed)) = added.stribeck {
            dry += rise / (slide.abs() / speed).exp();
        }
        if let Some((excess, rest_s, distance)) = added.breakaway {
            let (ageing, wearing) = (1.0 / rest_s, slide.abs() / distance);
            adhesion.step(ageing + wearing, ageing / (ageing + wearing));
            dry += excess * adhesion.state;
        }
        if let Some((change, at)) = added.step {
            dry += change * ((time_s - at) / RAMP_S + 0.5).clamp(0.0, 1.0);
        }
        if let Some((level, _, _)) = added.thermal {
            dry *= (1.0 + level * warmth.state).clamp(0.0, 3.0);
        }
        let mut direction = sign;
        if added.presliding_m > 0.0 {
            turned.step(slide.abs() / added.presliding_m, sign);
            direction = turned.state;
        }
        let friction = dry * direction
            + 0.5 * added.coulomb_asymmetry * sign * sign
            + self.viscous * driven.speed
            + added.viscous_asymmetry * driven.speed * sign;
        if let Some((_, resistance, time)) = added.thermal {
            warmth.step(1.0 / time, resistance * (friction * driven.speed).max(0.0));
        }
        let over_place =
            added.spring * driven.place + added.position_ripple.map_or(0.0, |r| wave(r, driven.place));
        // A weight on an arm, as a harmonic of one turn.
        let weight = wave((added.gravity[0], added.gravity[1], TAU), driven.place);
        let over_place = over_place + weight;
        (self.load_gain * load + self.inertia * driven.acceleration + friction + over_place, friction)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generator::motion::Course;

    const AXIS: RealAxis = RealAxis {
        rotary: true,
        inertia: 10.0,
        coulomb: 30.0,
        viscous: 20.0,
        load_coefficient: 0.08,
        load_gain: 0.0,
        radius_m: 0.07,
        sign_width_m_s: 1e-3,
        warm: 0.0,
    };

    fn run(hidden: &[HiddenEffect]) -> Signals {
        let motion = Motion { amplitude: 0.4, cycle_s: 4.5, course: Course::Strokes };
        let load = Load { mean_n: 20e3, swing: 0.0, period_s: 7.0, phase_rad: 0.0, ramp_s: 0.0 };
        AXIS.run(&Run { motion, load, phase_s: 0.0, length_s: 9.0, start_s: 0.0 }, hidden)
    }

    #[test]
    fn effort_is_the_balance_of_the_axis() {
        let signals = run(&[]);
        let (angle, speed) = (&signals.inputs[0].1, &signals.inputs[1].1);
        let (torque, friction) = (&signals.outputs[0].1, &signals.outputs[1].1);
        // Middle of the first, slow stroke: no acceleration, 142 N m dry friction, 20 N m s/rad.
        let i = ((0.08 + 0.27) * 4.5 / STEP_S) as usize;
        assert!(angle[i].abs() < 1e-3 && speed[i] > 0.5);
        assert!((torque[i] - 142.0 - 20.0 * speed[i]).abs() < 0.01, "{}", torque[i]);
        assert!((torque[i] + friction[i]).abs() < 0.01);
    }

    #[test]
    fn presliding_turns_friction_round_over_its_distance() {
        let distance = 1e-3;
        let signals = run(&[HiddenEffect::new("presliding-hysteresis", &[("distance_m", distance)])]);
        let plain = run(&[]);
        // After standstill at -0.4 rad, the sign follows `1 - exp(-x/d)` of the path.
        let (angle, with) = (&signals.inputs[0].1, &signals.outputs[1].1);
        let i = angle.iter().position(|x| (x + 0.4) * 0.07 > 2.0 * distance).unwrap();
        let share = (with[i] + 20.0 * signals.inputs[1].1[i])
            / (plain.outputs[1].1[i] + 20.0 * signals.inputs[1].1[i]);
        assert!((share - (1.0 - (-2.0_f64).exp())).abs() < 0.01, "{share}");
    }
}
