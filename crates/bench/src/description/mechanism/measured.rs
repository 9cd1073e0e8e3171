//! Channels of a mechanism's log: an entry of `[[measured]]` gives a channel of the catalogue a
//! body, a drive or a joint with clearance.

use crate::schema::section;
use crate::signals::Channel;

section! {
    /// Channels of a recorded log. A mechanism without them has no log.
    MeasuredEntry {
        /// Channel: `shaft_angle_rad` and `shaft_speed_rad_s` of a body, `spindle_angle_rad`,
        /// `spindle_speed_rad_s` and `drive_torque_nm` of a turning drive, `position_m`,
        /// `velocity_m_s` and `drive_force_n` of a sliding one, `journal_y_m`, `journal_z_m`,
        /// `bearing_force_y_n`, `bearing_force_z_n` and `friction_torque_nm` of a joint with
        /// clearance, along x and y.
        channel: Channel,
        /// Name of the body, or of the two bodies of drive or joint as in `log.csv` of a run, such
        /// as `ground_crank`.
        of: String,
    }
}
