//! Driven axis, independent of the engine: the effort of a given motion, rotary or linear.
//!
//! The effort follows from the balance of an axis, `effort = gain F + m a + k x + friction +
//! ripple`, and from the documented meaning of each effect (`docs/effects.md`). The states of
//! friction (its delayed sign, the time at standstill, a temperature) obey linear equations. An
//! implicit second-order rule steps them by a quarter of a millisecond. The sign of the speed is a
//! logistic function; a step of friction is a ramp of 10 ms. Sensors are in `sensing`. Units: SI,
//! efforts in N or N m.

use super::axis_data::{RealAxis, STEP_S};
use super::axis_effects::{Added, Memory};
use super::hidden::{HiddenEffect, total};
use super::motion::{Load, Motion};
use super::sensing::Signals;

/// Motion before the log begins, s.
const BEFORE_S: f64 = 0.2;

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
