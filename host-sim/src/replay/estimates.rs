//! Estimates as a CSV table.

use link::EstimateFrame;
use std::fmt::Write as _;

/// Formats estimates as CSV with the shortest numbers that read back exactly.
pub(crate) fn estimates_csv(estimates: &[EstimateFrame]) -> String {
    let mut text = String::from(
        "sequence,t_s,normal_force_n,force_y_n,force_z_n,friction_torque_nm,deformation_m,\
         contact_angle_rad,flags,saturated\n",
    );
    for e in estimates {
        let t = f64::from(e.time_us) * 1e-6;
        // Writing to text does not fail.
        let _ = writeln!(
            text,
            "{},{t:.6},{:e},{:e},{:e},{:e},{:e},{:e},{},{}",
            e.sequence,
            e.normal_force_n,
            e.force_y_n,
            e.force_z_n,
            e.friction_torque_nm,
            e.deformation_m,
            e.contact_angle_rad,
            e.flags,
            e.saturated
        );
    }
    text
}
