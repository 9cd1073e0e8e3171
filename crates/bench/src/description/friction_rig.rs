//! Description of a single driven axis with a measured effort.

use super::{AxisExtension, BearingMaterial, Load, Logging, Nuisances, is_zero};
use crate::channel::Channel;
use crate::effects::Effect;
use crate::log_format::{Columns, TextFormat};
use crate::motion::{Profile, sweep_s};
use crate::sensor::Sensor;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

section! {
    /// The driven axis of a friction rig.
    Axis {
        /// `rotary` (angle, torque) or `linear` (position, force).
        kind: AxisKind,
        /// Inertia in kg m2, or mass in kg.
        inertia: f64,
        /// Radius at which friction acts, m (rotary; 1 for a linear axis).
        friction_radius_m: f64,
        /// Share of the load that the measured effort carries directly (0: none; a cylinder's force: 1).
        load_gain: f64,
        /// Dry friction that does not depend on the load: effort in N or N m.
        coulomb_effort: f64,
        /// Viscous effort per speed, N s/m or N m s/rad.
        viscous_effort: f64,
        /// Coefficient of load-dependent dry friction.
        load_coefficient: f64,
        /// Width of the regularised sign, m/s at the friction radius.
        regularisation_m_s: f64,
        /// Difference of the dry effort between the directions, half of it each way.
        #[serde(default)]
        coulomb_asymmetry: f64,
        /// Period of the sinusoidal motion in s, for records.
        period_s: f64,
        /// Amplitude of the motion in rad or m, for records.
        amplitude: f64,
        /// Cycles of a record.
        #[serde(default = "one_cycle")]
        cycles: u32,
        /// Rest before each half cycle of a record, s.
        #[serde(default, skip_serializing_if = "is_zero")]
        dwell_s: f64,
        /// Period at the end of a record, s: the frequency then moves evenly from the one to the other; 0: it stays.
        #[serde(default, skip_serializing_if = "is_zero")]
        last_period_s: f64,
        /// Whether a record starts backwards.
        #[serde(default, skip_serializing_if = "is_forwards")]
        backwards: bool,
    }
}

section! {
    /// The rubbing pair of a friction rig; adds to the axis' own friction. See `friction_rig`.
    Surface {
        /// Which measured pair.
        material: BearingMaterial,
        /// Static friction after a long rest over that after none.
        break_away_ratio: f64,
        /// Time in s over which a rest builds it up.
        break_away_time_s: f64,
        /// Sliding distance in m over which it is lost.
        break_away_distance_m: f64,
        /// Lag of the coefficient behind the speed, s.
        lag_s: f64,
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

/// Description of a single driven axis with a measured effort.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrictionRig {
    /// Always `friction-rig`.
    pub plant: String,
    /// The axis.
    pub axis: Axis,
    /// The rubbing pair; none: the axis' own coefficient alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surface: Option<Surface>,
    /// Load.
    pub load: Load,
    /// Log.
    pub logging: Logging,
    /// Sensors by channel.
    #[serde(default)]
    pub sensors: BTreeMap<Channel, Sensor>,
    /// Standard deviation of what calibration may move, by parameter name.
    #[serde(default)]
    pub uncertain: BTreeMap<String, f64>,
    /// What is a session's own.
    #[serde(default, skip_serializing_if = "Nuisances::is_empty")]
    pub nuisances: Nuisances,
    /// How a foreign log is read.
    #[serde(default, skip_serializing_if = "TextFormat::is_default")]
    pub log: TextFormat,
    /// Where a foreign log's signals come from.
    #[serde(default, skip_serializing_if = "Columns::is_empty")]
    pub columns: Columns,
    /// Extensions beyond the nominal model.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub effects: Vec<Effect>,
    /// What effects switch on; never in a file.
    #[serde(skip)]
    pub extension: AxisExtension,
}

fn one_cycle() -> u32 {
    1
}

fn is_forwards(backwards: &bool) -> bool {
    !backwards
}

impl Axis {
    /// The described motion.
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
    /// Drive and effort channels of the axis: position, speed, effort.
    pub fn channels(&self) -> (Channel, Channel, Channel) {
        match self.axis.kind {
            crate::description::AxisKind::Rotary => {
                (Channel::SpindleAngle, Channel::SpindleSpeed, Channel::DriveTorque)
            }
            crate::description::AxisKind::Linear => {
                (Channel::Position, Channel::Velocity, Channel::DriveForce)
            }
        }
    }
}
