//! The impacts of a run as a table: `impacts.csv`, one row per contact, units in the header.
//!
//! A value that is not known yet is left empty: a contact that is open at the end of the run has no
//! duration.

use crate::atomic;
use crate::integrate::Impact;
use std::path::Path;

/// Name of the file in a run's folder.
pub const FILE_NAME: &str = "impacts.csv";

/// Header of the table.
pub const HEADER: &str = "contact,onset_s,crank_angle_rad,contact_angle_rad,approach_speed_m_s,\
latched_speed_m_s,peak_force_n,peak_s,max_deformation_m,duration_s,energy_lost_j,restitution,speed_ratio";

/// Returns the table as CSV. `latch_floor_m_s` is the floor of the contact law: the latched speed
/// is the larger of floor and approach speed. The loss is the work of the normal force; for an open
/// contact it includes the stored energy. `restitution` is that of the contact, from the works of
/// its force; `speed_ratio` is that of the bodies, which other forces may drive.
pub fn to_csv(impacts: &[Impact], latch_floor_m_s: f64) -> String {
    to_csv_with_floors(impacts, |_| latch_floor_m_s)
}

/// Returns the table as [`to_csv`] does, with a floor in m/s for each contact by its index.
pub fn to_csv_with_floors(impacts: &[Impact], latch_floor_m_s: impl Fn(usize) -> f64) -> String {
    let mut text = String::from(HEADER);
    text.push('\n');
    let optional = |value: Option<f64>| value.map(|v| format!("{v:e}")).unwrap_or_default();
    for i in impacts {
        text.push_str(&format!(
            "{},{:e},{:e},{:e},{:e},{:e},{:e},{:e},{:e},{},{:e},{},{}\n",
            i.contact,
            i.onset_s,
            i.angles.crank_rad,
            i.angles.contact_rad,
            i.approach_speed_m_s,
            i.approach_speed_m_s.max(latch_floor_m_s(i.contact)),
            i.peak_force_n,
            i.peak_s,
            i.max_deformation_m,
            optional(i.duration_s()),
            i.energy_lost_j,
            optional(i.restitution()),
            optional(i.speed_ratio()),
        ));
    }
    text
}

/// Writes the table atomically.
pub fn write(path: &Path, impacts: &[Impact], latch_floor_m_s: f64) -> std::io::Result<()> {
    atomic::write(path, to_csv(impacts, latch_floor_m_s).as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_have_the_fields_of_the_header_and_unknown_fields_are_empty() {
        let closed = Impact {
            onset_s: 1.0,
            approach_speed_m_s: 0.5,
            separation_s: Some(1.25),
            separation_speed_m_s: 0.2,
            compression_work_j: 1.0,
            energy_lost_j: 0.75,
            ..Impact::default()
        };
        let open = Impact { onset_s: 2.0, ..Impact::default() };
        let text = to_csv(&[closed, open], 1e-3);
        let rows: Vec<Vec<&str>> = text.lines().map(|l| l.split(',').collect()).collect();
        assert_eq!(rows.len(), 3);
        assert!(rows.iter().all(|r| r.len() == rows[0].len()));
        let field = |row: usize, name: &str| rows[row][rows[0].iter().position(|h| *h == name).unwrap()];
        assert_eq!((field(1, "duration_s"), field(1, "restitution")), ("2.5e-1", "5e-1"));
        assert_eq!((field(1, "speed_ratio"), field(2, "speed_ratio")), ("4e-1", ""));
        assert_eq!((field(2, "duration_s"), field(2, "restitution")), ("", ""));
        assert_eq!(field(2, "latched_speed_m_s"), "1e-3");
    }
}
