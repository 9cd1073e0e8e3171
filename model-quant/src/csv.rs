//! Rows as a table for people: comma-separated, one header line, SI units in the names.

use crate::features::FloatFeatures;
use crate::rows::Row;
use std::fmt::Write;

/// Columns of the table.
pub const COLUMNS: &str = "radial_clearance_m,deformation_m,deformation_rate_m_s,approach_speed_m_s,rate_ratio,\
                           sliding_speed_m_s,normal_force_n,friction_force_n";

/// The table of some rows. Numbers are the shortest that read back to the same value.
pub fn table(features: &FloatFeatures, rows: &[Row]) -> String {
    let mut text = String::with_capacity(100 * (rows.len() + 1));
    text.push_str(COLUMNS);
    text.push('\n');
    for row in rows {
        let state = &row.state;
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "{},{},{},{},{},{},{},{}",
            state.radial_clearance_m,
            state.deformation_m,
            state.deformation_rate_m_s,
            state.approach_speed_m_s,
            features.rate_ratio_of(state),
            state.sliding_speed_m_s,
            row.normal_force_n,
            row.friction_force_n
        );
    }
    text
}
