//! Estimates of a run or a replay as a CSV table.

use link::EstimateFrame;
use std::fmt::Write as _;

/// Name of the table.
pub(crate) const FILE_NAME: &str = "estimates.csv";

/// A column with a value of an estimate.
pub type Column = (&'static str, fn(&EstimateFrame) -> f32);

/// Columns after `sequence` and `t_s`, before `flags` and `saturated`.
pub const COLUMNS: [Column; 19] = [
    ("normal_force_n", |e| e.normal_force_n),
    ("normal_force_sd_n", |e| e.normal_force_sd_n),
    ("force_y_n", |e| e.force_y_n),
    ("force_z_n", |e| e.force_z_n),
    ("force_sd_n", |e| e.force_sd_n),
    ("friction_torque_nm", |e| e.friction_torque_nm),
    ("friction_torque_sd_nm", |e| e.friction_torque_sd_nm),
    ("deformation_m", |e| e.deformation_m),
    ("clearance_m", |e| e.clearance_m),
    ("clearance_sd_m", |e| e.clearance_sd_m),
    ("stiffness_factor", |e| e.stiffness_factor),
    ("stiffness_sd", |e| e.stiffness_sd),
    ("friction_factor", |e| e.friction_factor),
    ("friction_sd", |e| e.friction_sd),
    ("network_force_n", |e| e.network_force_n),
    ("network_torque_nm", |e| e.network_torque_nm),
    ("law_force_n", |e| e.law_force_n),
    ("law_torque_nm", |e| e.law_torque_nm),
    ("contact_angle_rad", |e| e.contact_angle_rad),
];

/// Formats estimates as CSV with the shortest numbers that read back exactly.
///
/// Deviations are `inf` while nothing is known and while an estimate is held.
pub(crate) fn to_csv(estimates: &[EstimateFrame]) -> String {
    let mut text = String::from("sequence,t_s");
    for (name, _) in COLUMNS {
        text.push(',');
        text.push_str(name);
    }
    text.push_str(",flags,saturated\n");
    for estimate in estimates {
        // Writing to text does not fail.
        let _ = write!(text, "{},{:.6}", estimate.sequence, f64::from(estimate.time_us) * 1e-6);
        for (_, value) in COLUMNS {
            let _ = write!(text, ",{:e}", value(estimate));
        }
        let _ = writeln!(text, ",{},{}", estimate.flags, estimate.saturated);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_has_a_value_for_every_column() {
        let estimate = EstimateFrame { sequence: 7, time_us: 700, clearance_m: 5e-4, ..Default::default() };
        let text = to_csv(&[estimate, estimate]);
        let counts: Vec<usize> = text.lines().map(|line| line.split(',').count()).collect();
        assert_eq!(counts, [23; 3]);
        let row: Vec<&str> = text.lines().nth(1).unwrap().split(',').collect();
        assert_eq!((row[0], row[1], row[10]), ("7", "0.000700", "5e-4"));
    }
}
