//! Drive and controller of an axis' simulated motion.
//!
//! The controller is a position PID whose output is the effort, or the ordered speed of a cascade:
//! `y = kp e + ki int(e) - kd v + speed_feedforward dw/dt` with `e = w - x`, the order `w`, the
//! position `x` and the speed `v`. With `speed_gain = 0` the output is `u = y`. Otherwise `y` is an
//! ordered speed, and `u = speed_gain s + speed_ki int(s)` with `s = y - v`. The ordered effort is
//! `gain u` within `effort_limit`. The derivative acts on the speed and not on the error, so a step
//! of the order gives no impulse; `speed_feedforward = kd` is the textbook PID.
//!
//! While the effort is limited, an integral whose input would raise it further is held.

use super::{Refusal, is_one, is_zero, one};
use crate::schema::{HUGE, TINY, named_field, section};
use serde::{Deserialize, Serialize};

/// Number of time constants after which a start is forgotten.
const SETTLING_TIMES: f64 = 8.0;

section! {
    /// Direction of the simulation, with the drive and the controller of a simulated motion.
    Drive {
        /// Quantity that is simulated. `motion` requires an inertia above 0.
        #[serde(default)]
        simulates: Simulated,
        /// Input of a simulated motion: `effort` (measured force or torque), `voltage`
        /// (`drive_voltage_v`), or `order` (closed loop: `ordered_position_m` or
        /// `ordered_angle_rad`, with the controller below; the effort is then compared too).
        #[serde(default, skip_serializing_if = "is_default")]
        input: DriveInput,
        /// Effort per volt (motor constant times amplifier gain), or per unit of the controller's
        /// output.
        #[serde(default = "one", skip_serializing_if = "is_one")]
        gain: f64 [TINY, HUGE, "N/V or N m/V"],
        /// Time constant of the first-order lag of the effort after voltage or controller.
        #[serde(default, skip_serializing_if = "is_zero")]
        time_constant_s: f64 [0.0, 1e3],
        /// Amplitude of the effort in records of an open loop. The effort has the shape of the
        /// described motion's speed, in addition to what load and constant effort need; 0: nothing
        /// more.
        #[serde(default, skip_serializing_if = "is_zero")]
        effort_amplitude: f64 [0.0, HUGE, "N or N m"],
        /// Controller's output per position error; with `speed_gain` the ordered speed per error.
        #[serde(default, skip_serializing_if = "is_zero")]
        kp: f64 [0.0, HUGE],
        /// Controller's output per integral of the position error.
        #[serde(default, skip_serializing_if = "is_zero")]
        ki: f64 [0.0, HUGE],
        /// Reduction of the controller's output per speed.
        #[serde(default, skip_serializing_if = "is_zero")]
        kd: f64 [0.0, HUGE],
        /// Controller's output per ordered speed: `kd` for the derivative of the error, 1 for the
        /// full feedforward of a cascade.
        #[serde(default, skip_serializing_if = "is_zero")]
        speed_feedforward: f64 [0.0, HUGE],
        /// Output per speed error of a cascade; 0: the position controller orders the effort.
        #[serde(default, skip_serializing_if = "is_zero")]
        speed_gain: f64 [0.0, HUGE],
        /// Output per integral of the speed error of a cascade.
        #[serde(default, skip_serializing_if = "is_zero")]
        speed_ki: f64 [0.0, HUGE],
        /// Largest ordered effort; 0: no limit.
        #[serde(default, skip_serializing_if = "is_zero")]
        effort_limit: f64 [0.0, HUGE, "N or N m"],
        /// Time between two outputs of the controller, which are held in between. 0, or less than
        /// a step of the simulation: continuous.
        #[serde(default, skip_serializing_if = "is_zero")]
        sample_period_s: f64 [0.0, 10.0],
    }
}

/// Quantity that the simulation of an axis returns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Simulated {
    /// The effort that a given motion needs: inverse dynamics.
    #[default]
    Effort,
    /// The motion under a given input: forward dynamics.
    Motion,
}

named_field!(Simulated { Effort "effort", Motion "motion" });

/// Input of a simulated motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DriveInput {
    /// Measured effort.
    #[default]
    Effort,
    /// Voltage of the drive.
    Voltage,
    /// Ordered position of a closed loop.
    Order,
}

named_field!(DriveInput { Effort "effort", Voltage "voltage", Order "order" });

fn is_default(input: &DriveInput) -> bool {
    *input == DriveInput::default()
}

impl Drive {
    /// Numbers that only some inputs use, with their defaults and those inputs.
    fn conditional(&self) -> [(&'static str, f64, f64, &'static [DriveInput]); 11] {
        use DriveInput::{Effort, Order, Voltage};
        [
            ("gain", self.gain, 1.0, &[Voltage, Order]),
            ("time_constant_s", self.time_constant_s, 0.0, &[Voltage, Order]),
            ("effort_amplitude", self.effort_amplitude, 0.0, &[Effort, Voltage]),
            ("kp", self.kp, 0.0, &[Order]),
            ("ki", self.ki, 0.0, &[Order]),
            ("kd", self.kd, 0.0, &[Order]),
            ("speed_feedforward", self.speed_feedforward, 0.0, &[Order]),
            ("speed_gain", self.speed_gain, 0.0, &[Order]),
            ("speed_ki", self.speed_ki, 0.0, &[Order]),
            ("effort_limit", self.effort_limit, 0.0, &[Order]),
            ("sample_period_s", self.sample_period_s, 0.0, &[Order]),
        ]
    }

    /// Entries that contradict the direction or the input, or that it lacks.
    pub(super) fn refusals(&self) -> Vec<Refusal> {
        let refuse =
            |name: &str, found: String, expected: &str| (format!("drive.{name}"), found, expected.to_owned());
        let mut all = Vec::new();
        let is_motion = self.simulates == Simulated::Motion;
        for (name, value, default, inputs) in self.conditional() {
            if value == default || (is_motion && inputs.contains(&self.input)) {
                continue;
            }
            let expected = match (is_motion, inputs) {
                (false, _) => "no value with simulates = \"effort\"",
                (true, [DriveInput::Order]) => "no value without input = \"order\"",
                (true, [DriveInput::Voltage, _]) => "no value without input = \"voltage\" or \"order\"",
                (true, _) => "no value with input = \"order\": a record follows the described motion",
            };
            all.push(refuse(name, super::format_number(value), expected));
        }
        if !is_motion && self.input != DriveInput::Effort {
            let found = crate::schema::FieldType::text(&self.input);
            all.push(refuse("input", format!("`{found}`"), "no input with simulates = \"effort\""));
        }
        if is_motion && self.input == DriveInput::Order {
            if self.kp == 0.0 && self.ki == 0.0 {
                all.push(refuse("kp", "0".into(), "kp or ki above 0 with input = \"order\""));
            }
            if self.speed_ki != 0.0 && self.speed_gain == 0.0 {
                let expected = "no value without speed_gain above 0";
                all.push(refuse("speed_ki", super::format_number(self.speed_ki), expected));
            }
        }
        all
    }

    /// Time in which a controller forgets its start, s; 0 in open loop. The integrals at the start
    /// of a log are hardly known.
    pub(super) fn settling_s(&self) -> f64 {
        if self.input != DriveInput::Order {
            return 0.0;
        }
        let ratio = |a: f64, b: f64| if b > 0.0 { a / b } else { 0.0 };
        let position_s = if self.speed_gain > 0.0 { ratio(1.0, self.kp) } else { ratio(self.kd, self.kp) };
        let integral_s = ratio(self.kp, self.ki) + ratio(self.speed_gain, self.speed_ki);
        SETTLING_TIMES * (position_s + integral_s + self.time_constant_s)
    }

    /// A number that may be declared uncertain, by its name; none if the input does not use it.
    pub(super) fn parameter_mut(&mut self, name: &str) -> Option<&mut f64> {
        let uses = |(other, _, _, inputs): &(&str, f64, f64, &[DriveInput])| {
            *other == name && inputs.contains(&self.input)
        };
        if !self.conditional().iter().any(uses) {
            return None;
        }
        match name {
            "gain" => Some(&mut self.gain),
            "time_constant_s" => Some(&mut self.time_constant_s),
            "kp" => Some(&mut self.kp),
            "ki" => Some(&mut self.ki),
            "kd" => Some(&mut self.kd),
            "speed_gain" => Some(&mut self.speed_gain),
            "speed_ki" if self.speed_gain > 0.0 => Some(&mut self.speed_ki),
            _ => None,
        }
    }
}
