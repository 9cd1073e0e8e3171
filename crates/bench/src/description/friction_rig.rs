//! Description of a single driven axis with a measured effort.

use super::plant::log_rate;
use super::plant::plant_description;
use super::{
    AxisExtension, Drive, DriveChannels, DriveInput, Field, Load, Logging, Plant, PlantDescription, Range,
    Refusal, is_zero,
};
use crate::schema::{HUGE, TINY, named_field, section};
use crate::signals::{Channel, Profile, Role, sweep_s};
use contact::BearingMaterial;
use serde::{Deserialize, Serialize};

section! {
    /// The driven axis of a friction rig.
    Axis {
        /// `rotary` (angle, torque) or `linear` (position, force).
        kind: AxisKind,
        /// Moment of inertia, or mass of a linear axis.
        inertia: f64 [0.0, 1e9, "kg or kg m2"],
        /// Radius at which friction acts; 1 for a linear axis.
        friction_radius_m: f64 [1e-6, 1e3],
        /// Share of the load that the measured effort contains (0: none; a cylinder's force: 1).
        load_gain: f64 [-1e3, 1e3],
        /// Dry friction that does not depend on the load.
        coulomb_effort: f64 [0.0, HUGE, "N or N m"],
        /// Viscous friction per speed.
        viscous_effort: f64 [0.0, HUGE, "N s/m or N m s/rad"],
        /// Coefficient of load-dependent dry friction.
        load_coefficient: f64 [0.0, 10.0],
        /// Width of the regularised sign: speed at the friction radius below which friction rises
        /// smoothly.
        regularisation_m_s: f64 [TINY, 1e3],
        /// Difference of the dry effort between the directions, half of it each way.
        #[serde(default)]
        coulomb_asymmetry: f64 [-HUGE, HUGE, "N or N m"],
        /// Effort that acts always: gravity, preload, bias of the drive.
        #[serde(default, skip_serializing_if = "is_zero")]
        constant_effort: f64 [-HUGE, HUGE, "N or N m"],
        /// Effort per displacement from the neutral position, positive for a spring that pulls
        /// back.
        #[serde(default, skip_serializing_if = "is_zero")]
        spring_stiffness: f64 [-HUGE, HUGE, "N/m or N m/rad"],
        /// Moment of gravity at the angle 0 (`rotary` only): that of an unbalanced mass at the
        /// height of the axis.
        #[serde(default, skip_serializing_if = "is_zero")]
        gravity_cos: f64 [-HUGE, HUGE, "N m"],
        /// Moment of gravity at a quarter of a turn (`rotary` only).
        #[serde(default, skip_serializing_if = "is_zero")]
        gravity_sin: f64 [-HUGE, HUGE, "N m"],
        /// Position at which a spring has no effort and friction its described level: the middle of
        /// the stroke, if nothing else is known.
        #[serde(default, skip_serializing_if = "is_zero")]
        neutral_position: f64 [-1e6, 1e6, "m or rad"],
        /// Play between the drive and the rubbing part, at the friction radius: after a reversal
        /// friction is absent until the drive has crossed it.
        #[serde(default, skip_serializing_if = "is_zero")]
        play: f64 [0.0, 1e3, "m"],
        /// Deflection of the coupling between the drive and the rubbing part per friction effort.
        #[serde(default, skip_serializing_if = "is_zero")]
        coupling_compliance: f64 [0.0, 1e6, "m/N or rad/(N m)"],
        /// Period of the sinusoidal motion, for records.
        period_s: f64 [1e-3, 1e6],
        /// Amplitude of the motion (half the stroke), for records.
        amplitude: f64 [1e-9, 1e6, "m or rad"],
        /// Cycles of a record.
        #[serde(default = "one_cycle")]
        cycles: u32 [1.0, 1e6],
        /// Standstill before each half cycle of a record; 0 with a sweep.
        #[serde(default, skip_serializing_if = "is_zero")]
        dwell_s: f64 [0.0, 1e6],
        /// Period at the end of a record, with a frequency that changes linearly; at least 0.001 s,
        /// or 0 for a constant frequency.
        #[serde(default, skip_serializing_if = "is_zero")]
        last_period_s: f64 [0.0, 1e6],
        /// True if a record starts backwards.
        #[serde(default, skip_serializing_if = "is_forwards")]
        backwards: bool,
    }
}

section! {
    /// The rubbing pair of a friction rig. Its friction adds to the axis' own friction. See
    /// `plants::friction_rig`.
    Surface {
        /// Material of the measured pair.
        material: BearingMaterial,
        /// Ratio of static friction after a long standstill to that after none.
        break_away_ratio: f64 [1.0, 10.0],
        /// Time of standstill over which it builds up.
        break_away_time_s: f64 [1e-6, HUGE],
        /// Sliding distance over which it is lost.
        break_away_distance_m: f64 [1e-9, HUGE],
        /// Lag of the coefficient after the speed.
        lag_s: f64 [0.0, 10.0],
    }
}

/// Kind of a driven axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AxisKind {
    /// Angle and torque.
    Rotary,
    /// Position and force.
    Linear,
}

named_field!(AxisKind { Rotary "rotary", Linear "linear" });

plant_description! {
    /// Description of a single driven axis with a measured effort.
    FrictionRig as FrictionRigFile "FrictionRigFile", plant "friction-rig", extension AxisExtension {
        /// Always `friction-rig`.
        plant: String,
        /// The axis.
        axis: Axis,
        /// Rubbing pair; without one only the axis' own friction acts.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        surface: Option<Surface>,
        /// Direction of the simulation. With `simulates = "effort"`, or without the section, the
        /// measured motion is the input and the effort is compared. With `simulates = "motion"` an
        /// effort, a voltage or an order is the input, and position and speed are compared. The
        /// simulation begins with the smoothed position and speed of the log's first sample. In
        /// closed loop the error `e = order - position` gives `y = kp e + ki integral(e) - kd speed
        /// + speed_feedforward d(order)/dt`, the controller's output. With a `speed_gain` it is an
        /// ordered speed, and the output is `speed_gain s + speed_ki integral(s)` with `s = y -
        /// speed`. So `kp` with `speed_gain` and `speed_ki` is the cascade of servo axes, and
        /// `speed_feedforward = kd` the PID with the derivative of the error. The effort is `gain`
        /// times the output within `effort_limit`; an integral that would raise a limited effort
        /// further is held. `[uncertain]` accepts `gain`, `time_constant_s`, `kp`, `ki`, `kd`,
        /// `speed_gain` and `speed_ki`, as in `"drive.gain" = 0.5`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        drive: Option<Drive>,
        /// Load.
        load: Load,
        /// Log.
        logging: Logging,
    }
}

fn one_cycle() -> u32 {
    1
}

fn is_forwards(backwards: &bool) -> bool {
    !backwards
}

impl Axis {
    /// Described motion.
    pub fn motion(&self) -> Profile {
        let stroke = if self.backwards { -2.0 * self.amplitude } else { 2.0 * self.amplitude };
        let (period_s, cycles) = (self.period_s, f64::from(self.cycles));
        if self.last_period_s > 0.0 {
            Profile::Sweep { stroke, period_s, last_period_s: self.last_period_s, cycles }
        } else if self.dwell_s > 0.0 {
            Profile::Resting { stroke, period_s, cycles, dwell_s: self.dwell_s }
        } else {
            Profile::Cycles { stroke, period_s, cycles }
        }
    }

    /// Length of a record in s.
    pub fn duration_s(&self) -> f64 {
        let cycles = f64::from(self.cycles);
        if self.last_period_s > 0.0 {
            return sweep_s(self.period_s, self.last_period_s, cycles);
        }
        cycles * (self.period_s + 2.0 * self.dwell_s)
    }
}

impl FrictionRig {
    /// Channels of the axis: position, speed, effort.
    pub fn channels(&self) -> (Channel, Channel, Channel) {
        match self.axis.kind {
            AxisKind::Rotary => (Channel::SpindleAngle, Channel::SpindleSpeed, Channel::DriveTorque),
            AxisKind::Linear => (Channel::Position, Channel::Velocity, Channel::DriveForce),
        }
    }
}

/// Largest share of a log that is left out until the controller has settled.
const MAX_SETTLING_SHARE: f64 = 0.25;

/// Omissions of the model.
const LIMITS: &[&str] = &[
    "The motion is given: the axis cannot stick, slip or vibrate.",
    "The rubbing part beyond play and coupling has no mass, and starts in the middle of its play.",
    "The friction of the surfaces is an assumption in the shape of published curves.",
    "The load is the same over the whole surface; wear and temperature are not modelled.",
    "Below the width of the regularised sign, friction rises with speed, not displacement.",
];

/// Omissions of the model with a simulated motion.
const FORWARD_LIMITS: &[&str] = &[
    "At standstill the axis creeps within the width of the regularised sign.",
    "The friction of the surfaces is an assumption in the shape of published curves.",
    "The load is the same over the whole surface; wear and temperature are not modelled.",
    "Drive and controller are linear but for the limit of the effort; their sensors are exact.",
];

impl PlantDescription for FrictionRig {
    fn period_s(&self) -> f64 {
        self.axis.period_s
    }

    fn stroke(&self) -> f64 {
        2.0 * self.axis.amplitude
    }

    fn duration_s(&self) -> f64 {
        self.axis.duration_s()
    }

    fn cycles_field(&self) -> &'static str {
        "axis.cycles"
    }

    fn set_cycles(&mut self, cycles: u32) {
        self.axis.cycles = cycles;
    }

    fn dependent_ranges(&self) -> Vec<Range> {
        let axis = &self.axis;
        // A sweep has no standstill.
        let max_dwell_s = if axis.last_period_s > 0.0 { 0.0 } else { 1e6 };
        let min_last_period_s = if axis.last_period_s == 0.0 { 0.0 } else { 1e-3 };
        // A simulated motion has a rigid drive.
        let max_play = if self.forward().is_some() { 0.0 } else { HUGE };
        let max_moment = if axis.kind == AxisKind::Rotary { HUGE } else { 0.0 };
        vec![
            ("axis.play", axis.play, 0.0, max_play),
            ("axis.coupling_compliance", axis.coupling_compliance, 0.0, max_play),
            ("axis.gravity_cos", axis.gravity_cos, -max_moment, max_moment),
            ("axis.gravity_sin", axis.gravity_sin, -max_moment, max_moment),
            ("axis.dwell_s", axis.dwell_s, 0.0, max_dwell_s),
            ("axis.last_period_s", axis.last_period_s, min_last_period_s, 1e6),
            self.inertia_range(),
            log_rate(&self.logging, self.duration_s()),
        ]
    }

    fn limits(&self) -> &'static [&'static str] {
        if self.forward().is_some() { FORWARD_LIMITS } else { LIMITS }
    }

    fn refusals(&self) -> Vec<Refusal> {
        self.drive.as_ref().map(Drive::refusals).unwrap_or_default()
    }

    fn plant_parameter_mut(&mut self, name: &str) -> Option<&mut f64> {
        match name {
            "axis.inertia" => Some(&mut self.axis.inertia),
            "axis.load_gain" => Some(&mut self.axis.load_gain),
            "axis.coulomb_effort" => Some(&mut self.axis.coulomb_effort),
            "axis.viscous_effort" => Some(&mut self.axis.viscous_effort),
            "axis.load_coefficient" => Some(&mut self.axis.load_coefficient),
            "axis.constant_effort" => Some(&mut self.axis.constant_effort),
            "axis.gravity_cos" if self.axis.kind == AxisKind::Rotary => Some(&mut self.axis.gravity_cos),
            "axis.gravity_sin" if self.axis.kind == AxisKind::Rotary => Some(&mut self.axis.gravity_sin),
            "axis.spring_stiffness" => Some(&mut self.axis.spring_stiffness),
            "axis.play" if self.forward().is_none() => Some(&mut self.axis.play),
            "axis.coupling_compliance" if self.forward().is_none() => {
                Some(&mut self.axis.coupling_compliance)
            }
            _ => {
                let name = name.strip_prefix("drive.").filter(|_| self.forward().is_some())?;
                self.drive.as_mut()?.parameter_mut(name)
            }
        }
    }

    fn period_mut(&mut self) -> Option<Field<'_>> {
        // The speed of an open loop follows from the effort, and so does the stroke.
        if self.is_open_loop() {
            return None;
        }
        Some(("axis.period_s", &mut self.axis.period_s))
    }

    fn stroke_mut(&mut self) -> Option<Field<'_>> {
        if self.is_open_loop() {
            return None;
        }
        Some(("axis.amplitude", &mut self.axis.amplitude))
    }

    fn load(&self) -> Option<&Load> {
        Some(&self.load)
    }

    fn load_mut(&mut self) -> Option<&mut Load> {
        Some(&mut self.load)
    }

    fn has_thermal_friction(&self) -> bool {
        self.extension.thermal.is_some()
    }

    fn set_temperature_start_k(&mut self, rise_k: f64) {
        self.extension.temperature_start_k = rise_k;
    }

    fn effect_plant(&self) -> Option<Plant> {
        Some(match self.axis.kind {
            AxisKind::Rotary => Plant::Rotary,
            AxisKind::Linear => Plant::Linear,
        })
    }

    fn sample_rate_hz(&self) -> f64 {
        self.logging.sample_rate_hz
    }

    fn drive_channels(&self) -> Option<DriveChannels> {
        let (position, speed, _) = self.channels();
        Some(DriveChannels { position, speed })
    }

    fn role(&self, channel: Channel) -> Role {
        self.role_of(channel)
    }

    fn is_open_loop(&self) -> bool {
        self.forward().is_some_and(|drive| drive.input != DriveInput::Order)
    }

    fn steady_span_s(&self, (start_s, end_s): (f64, f64), _margins_s: (f64, f64)) -> (f64, f64) {
        let settling_s = self.forward().map_or(0.0, Drive::settling_s);
        (start_s + settling_s.min(MAX_SETTLING_SHARE * (end_s - start_s)), end_s)
    }

    fn simulates(&self, channel: Channel) -> bool {
        if self.forward().is_some() {
            return self.simulates_forward(channel);
        }
        channel == self.channels().2 || channel == Channel::FrictionTorque
    }
}
