//! Sample of the sensors.

/// One sample of the sensors, SI units.
#[derive(Clone, Copy, Debug, Default)]
pub struct Measurement {
    /// Position of the journal along Y from the centre of the bearing, m.
    pub journal_y_m: f32,
    /// Position of the journal along Z, upwards, m.
    pub journal_z_m: f32,
    /// Angle of the shaft, rad.
    pub shaft_angle_rad: f32,
    /// Load along Y, N.
    pub load_force_n: f32,
    /// Force of the drive on the crank pin along Y, N, where it is measured.
    pub drive_force_n: Option<f32>,
}

impl Measurement {
    /// Returns true if every value is a number.
    pub(super) fn is_complete(&self) -> bool {
        let Self { journal_y_m, journal_z_m, shaft_angle_rad, load_force_n, drive_force_n } = *self;
        [journal_y_m, journal_z_m, shaft_angle_rad, load_force_n, drive_force_n.unwrap_or_default()]
            .iter()
            .all(|value| value.is_finite())
    }
}
