//! A row of a run: all true quantities at one time, in SI.

/// All true quantities at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    /// Time.
    pub time_s: f64,
    /// Journal centre along Y from the bearing's centre.
    pub journal_y_m: f64,
    /// Journal centre along Z, upwards.
    pub journal_z_m: f64,
    /// Velocity of the journal along Y.
    pub velocity_y_m_s: f64,
    /// Velocity of the journal along Z.
    pub velocity_z_m_s: f64,
    /// Crank angle.
    pub shaft_angle_rad: f64,
    /// Crank speed.
    pub shaft_speed_rad_s: f64,
    /// Velocity of the drive.
    pub drive_velocity_m_s: f64,
    /// Force of the fork on the shaft along +Y.
    pub drive_force_n: f64,
    /// Load along +Y.
    pub load_force_n: f64,
    /// Normal contact force, not negative.
    pub normal_force_n: f64,
    /// Friction force on the shaft along `t`.
    pub friction_force_n: f64,
    /// Force of the bearing on the journal along Y.
    pub force_y_n: f64,
    /// Force of the bearing on the journal along Z.
    pub force_z_n: f64,
    /// Torque of the bearing on the shaft.
    pub friction_torque_nm: f64,
    /// Deformation, negative in a gap.
    pub deformation_m: f64,
    /// Rate of the deformation.
    pub deformation_rate_m_s: f64,
    /// Relative tangential speed in the contact.
    pub sliding_speed_m_s: f64,
}
