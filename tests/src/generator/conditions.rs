//! Conditions under which an axis is logged: usual and hard.
//!
//! Under hard conditions the axis is at standstill between its strokes, the sign of friction
//! changes within 1 mm/s, and a coarse logger reads 200 times a second with a resolution of half
//! the noise. A standstill begins and ends within a few samples, in which friction changes its
//! sign. A reading at standstill repeats one code.

use super::motion::Course;
use super::plant::{BENCH_SENSORS, Plant};
use super::sensing::Reading;

/// Conditions of a log; the transmission bench has only the usual ones.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Conditions {
    /// Swing, wide sign, fine readings.
    #[default]
    Usual,
    /// Strokes with standstill, narrow sign, coarse readings.
    Hard,
}

/// Channel, noise, resolution.
type Row = (&'static str, f64, f64);

impl Conditions {
    /// Returns the user's description (TOML).
    pub const fn description(self, plant: Plant) -> &'static str {
        match (self, plant) {
            (Self::Hard, Plant::Rotary) => include_str!("rotary-hard.toml"),
            (Self::Hard, Plant::Linear) => include_str!("linear-hard.toml"),
            _ => plant.description(),
        }
    }

    /// Returns the sensors of inputs and outputs.
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
            (Plant::Bench | Plant::TwoPlane, _) => BENCH_SENSORS,
        };
        rows.iter().map(of).collect()
    }

    /// Returns the sample rate of an axis, Hz.
    pub(crate) const fn axis_rate_hz(self) -> f64 {
        match self {
            Self::Usual => 250.0,
            Self::Hard => 200.0,
        }
    }

    /// Returns the width of the friction sign, m/s.
    pub fn sign_width_m_s(self, plant: Plant) -> f64 {
        match (self, plant) {
            (Self::Hard, _) => 1e-3,
            (Self::Usual, Plant::Rotary) => 6e-3,
            (Self::Usual, _) => 12e-3,
        }
    }

    /// Returns the course of an axis' motion.
    pub const fn course(self) -> Course {
        match self {
            Self::Usual => Course::Swing,
            Self::Hard => Course::Strokes,
        }
    }
}
