//! Under which conditions an axis is logged: the usual ones, and hard ones.
//!
//! Hard: the axis rests between its strokes, friction turns its sign within 1 mm/s, a coarse logger reads 200 times a second and
//! its efforts only to half of their noise. A rest begins and ends in a few samples in which friction turns round, and a reading at
//! rest falls on the same step again and again.

use super::motion::Course;
use super::planar;
use super::sensing::Reading;
use super::session::Plant;

/// Conditions of a log; the transmission bench has the usual ones only.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Conditions {
    /// A swing, a wide sign, fine readings.
    #[default]
    Usual,
    /// Strokes with rests, a narrow sign, coarse readings.
    Hard,
}

/// Channel, noise, resolution.
type Row = (&'static str, f64, f64);

impl Conditions {
    /// The description that a user has: TOML.
    pub const fn description(self, plant: Plant) -> &'static str {
        match (self, plant) {
            (Self::Hard, Plant::Rotary) => include_str!("rotary-hard.toml"),
            (Self::Hard, Plant::Linear) => include_str!("linear-hard.toml"),
            _ => plant.description(),
        }
    }

    /// Sensors of inputs and outputs.
    pub fn sensors(self, plant: Plant) -> Vec<Reading> {
        let of = |&(channel, noise, resolution): &Row| Reading { channel, noise, resolution };
        let rows: &[Row] = match (plant, self) {
            (Plant::Rotary, Self::Usual) => &[
                ("spindle_angle_rad", 2e-6, 1e-6),
                ("spindle_speed_rad_s", 5e-5, 1e-5),
                ("load_force_n", 5.0, 1.0),
                ("drive_torque_nm", 1.0, 0.1),
                ("friction_torque_nm", 1.0, 0.1),
            ],
            (Plant::Rotary, Self::Hard) => &[
                ("spindle_angle_rad", 2e-6, 1e-6),
                ("spindle_speed_rad_s", 5e-5, 1e-5),
                ("load_force_n", 5.0, 1.0),
                ("drive_torque_nm", 1.0, 0.5),
                ("friction_torque_nm", 1.0, 0.5),
            ],
            (Plant::Linear, Self::Usual) => &[
                ("position_m", 5e-7, 2e-7),
                ("velocity_m_s", 1e-5, 2e-6),
                ("load_force_n", 0.1, 0.05),
                ("drive_force_n", 3.0, 0.3),
            ],
            (Plant::Linear, Self::Hard) => &[
                ("position_m", 5e-7, 2e-7),
                ("velocity_m_s", 1e-5, 2e-6),
                ("load_force_n", 0.5, 0.2),
                ("drive_force_n", 3.0, 1.5),
            ],
            (Plant::Bench | Plant::TwoPlane, _) => planar::SENSORS,
        };
        rows.iter().map(of).collect()
    }

    /// Samples a second on an axis.
    pub const fn axis_rate_hz(self) -> f64 {
        match self {
            Self::Usual => 250.0,
            Self::Hard => 200.0,
        }
    }

    /// Width of the sign of friction in m/s.
    pub fn sign_width_m_s(self, plant: Plant) -> f64 {
        match (self, plant) {
            (Self::Hard, _) => 1e-3,
            (Self::Usual, Plant::Rotary) => 6e-3,
            (Self::Usual, _) => 12e-3,
        }
    }

    /// Course of an axis' motion.
    pub const fn course(self) -> Course {
        match self {
            Self::Usual => Course::Swing,
            Self::Hard => Course::Strokes,
        }
    }
}
