//! Rows as CSV: one header line, SI units in the column names.

use crate::data::features::FloatFeatures;
use crate::data::rows::Row;
use std::fmt::Write;

/// Columns of the table.
pub(crate) const COLUMNS: &str = "radial_clearance_m,deformation_m,deformation_rate_m_s,\
                                  approach_speed_m_s,rate_ratio,sliding_speed_m_s,\
                                  normal_force_n,friction_force_n";

/// Formats rows as CSV. Numbers are the shortest decimals that parse to the same value.
pub(crate) fn table(features: &FloatFeatures, rows: &[Row]) -> String {
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
            features.unclamped_rate_ratio(state),
            state.sliding_speed_m_s,
            row.normal_force_n,
            row.friction_force_n
        );
    }
    text
}
