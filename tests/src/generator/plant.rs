//! The simulated plants: their descriptions, uncertain parameters and outputs.

/// Channel, noise and resolution of every sensor of a transmission bench.
pub(crate) const BENCH_SENSORS: &[(&str, f64, f64)] = &[
    ("drive_displacement_m", 0.0, 1e-8),
    ("drive_velocity_m_s", 0.0, 1e-6),
    ("load_force_n", 0.5, 0.1),
    ("shaft_angle_rad", 20e-6, 5e-6),
    ("shaft_speed_rad_s", 2e-3, 5e-4),
    ("journal_y_m", 0.2e-6, 0.05e-6),
    ("journal_z_m", 0.2e-6, 0.05e-6),
    ("bearing_force_y_n", 15.0, 4.0),
    ("bearing_force_z_n", 15.0, 4.0),
    ("friction_torque_nm", 0.4, 0.1),
    ("drive_force_n", 20.0, 5.0),
];

/// Names of the outputs of a transmission bench, in the order of [`BENCH_SENSORS`].
pub(crate) const BENCH_OUTPUTS: &[&str] = &[
    "shaft_angle_rad",
    "shaft_speed_rad_s",
    "journal_y_m",
    "journal_z_m",
    "bearing_force_y_n",
    "bearing_force_z_n",
    "friction_torque_nm",
    "drive_force_n",
];

/// Simulated plant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Plant {
    /// Friction rig with drive torque and friction torque.
    Rotary,
    /// Cylinder of which only the force is measured.
    Linear,
    /// Transmission bench B.
    Bench,
    /// Transmission bench B with a shaft that may tilt in its bearing.
    TwoPlane,
}

impl Plant {
    /// All plants.
    pub const ALL: [Self; 4] = [Self::Rotary, Self::Linear, Self::Bench, Self::TwoPlane];

    /// Returns whether the plant is a transmission bench, not a single axis.
    pub const fn is_transmission(self) -> bool {
        matches!(self, Self::Bench | Self::TwoPlane)
    }

    /// Returns the name in the figures.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Rotary => "rotary",
            Self::Linear => "linear",
            Self::Bench => "bench",
            Self::TwoPlane => "two-plane",
        }
    }

    /// Returns the user's description (TOML).
    pub const fn description(self) -> &'static str {
        match self {
            Self::Rotary => include_str!("rotary.toml"),
            Self::Linear => include_str!("linear.toml"),
            Self::Bench => include_str!("transmission.toml"),
            Self::TwoPlane => concat!(include_str!("transmission.toml"), include_str!("two-plane.toml")),
        }
    }

    /// Returns the declared standard deviations of the parameters that calibration may move, in the
    /// order of `Record::off`.
    pub const fn deviations(self) -> &'static [f64] {
        match self {
            Self::Rotary => &[0.2, 0.2, 0.5, 3e-4],
            Self::Linear => &[2.0, 0.6, 3.0, 6e-4, 6e-4],
            Self::Bench | Self::TwoPlane => &[0.9e-3, 1.08e-3, 3.0, 3.0, 10e-6, 2.5e9, 0.03],
        }
    }

    /// Returns the time at the start of a log in which the journal of a transmission bench lands
    /// and bounces, s.
    ///
    /// The times of the bounces depend on every parameter, so this time does not count.
    pub(crate) const fn landing_s(self) -> f64 {
        match self {
            Self::Rotary | Self::Linear => 0.0,
            Self::Bench | Self::TwoPlane => 0.06,
        }
    }

    /// Returns the names of the outputs.
    pub const fn outputs(self) -> &'static [&'static str] {
        match self {
            Self::Rotary => &["drive_torque_nm", "friction_torque_nm"],
            Self::Linear => &["drive_force_n"],
            Self::Bench | Self::TwoPlane => BENCH_OUTPUTS,
        }
    }
}
