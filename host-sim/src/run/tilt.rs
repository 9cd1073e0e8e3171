//! Tilt of a run in two planes: angles and edge loads over time, load along the bearing's length.

use bench::description::TransmissionBench;
use bench::plants::two_plane::TwoPlaneSnapshot;
use bench::statistics::mean;
use report::figure::{Chart, Series, Style, lines};
use report::page::Page;

/// Name of the table inside a run's folder.
pub(crate) const FILE_NAME: &str = "tilt.csv";
const SIZE: (u32, u32) = (512, 320);
/// N/m per N/mm.
const PER_MM: f64 = 1e-3;

/// Formats tilt, moments and line load of every slice over time, for every n-th sample.
pub(crate) fn to_csv(samples: &[TwoPlaneSnapshot], every: usize) -> String {
    let slices = samples.first().map_or(0, |s| s.slices.len());
    let mut text = String::from("t_s,tilt_about_y_rad,tilt_about_z_rad,moment_y_nm,moment_z_nm");
    (1..=slices).for_each(|k| text.push_str(&format!(",line_load_{k}_n_m")));
    text.push('\n');
    for s in samples.iter().step_by(every.max(1)) {
        text.push_str(&format!(
            "{:e},{:e},{:e},{:e},{:e}",
            s.planar.time_s, s.tilt_about_y_rad, s.tilt_about_z_rad, s.moment_y_nm, s.moment_z_nm
        ));
        s.slices.iter().for_each(|slice| text.push_str(&format!(",{:e}", slice.line_load_n_m)));
        text.push('\n');
    }
    text
}

fn line_load(sample: &TwoPlaneSnapshot, slice: usize) -> f64 {
    sample.slices.get(slice).map_or(0.0, |s| s.line_load_n_m)
}

fn mean_load(sample: &TwoPlaneSnapshot) -> f64 {
    mean(sample.slices.iter().map(|s| s.line_load_n_m))
}

fn edge_load(sample: &TwoPlaneSnapshot) -> f64 {
    line_load(sample, 0).max(line_load(sample, sample.slices.len().saturating_sub(1)))
}

/// Adds the pictures. An error describes a failure of drawing.
pub(crate) fn section(
    page: &mut Page,
    bench: &TransmissionBench,
    samples: &[TwoPlaneSnapshot],
) -> Result<(), String> {
    let over_time = |name: &str, read: &dyn Fn(&TwoPlaneSnapshot) -> f64| {
        Series::new(name, samples.iter().map(|s| s.planar.time_s), samples.iter().map(read))
    };
    let last = samples.first().map_or(0, |s| s.slices.len().saturating_sub(1));
    let angles = [
        over_time("about Y", &|s| 1e3 * s.tilt_about_y_rad),
        over_time("about Z", &|s| 1e3 * s.tilt_about_z_rad),
    ];
    let loads = [
        over_time("end at -L/2", &|s| PER_MM * line_load(s, 0)),
        over_time("end at +L/2", &|s| PER_MM * line_load(s, last)),
        over_time("mean", &|s| PER_MM * mean_load(s)),
    ];
    let counted = || samples.iter().filter(|s| s.planar.time_s >= bench.load.ramp_s);
    let at_most = |read: fn(&TwoPlaneSnapshot) -> f64| counted().max_by(|a, b| read(a).total_cmp(&read(b)));
    let along = |name: String, sample: &TwoPlaneSnapshot| {
        let point = |s: &bench::plants::two_plane::SliceLoad| (1e3 * s.position_m, PER_MM * s.line_load_n_m);
        Series::through(name, sample.slices.iter().map(point).collect()).styled(Style::Both)
    };
    let moments: Vec<Series> = [
        ("largest force", at_most(|s| s.planar.forces.normal_n)),
        ("largest end load", at_most(edge_load)),
        ("end of the run", samples.last()),
    ]
    .into_iter()
    .filter_map(|(name, sample)| {
        let sample = sample?;
        Some(along(format!("{name}, {:.3} s", sample.planar.time_s), sample))
    })
    .collect();
    let chart = |title, x, y| Chart { title, x, y, size: SIZE };
    page.section("Tilt and load along the bearing");
    page.figures(&[
        (lines(&chart("Tilt of the shaft", "time, s", "mrad"), &angles)?, "Against the machine's axis."),
        (
            lines(&chart("Line load at the ends", "time, s", "N/mm"), &loads)?,
            "Normal force per length of the two end slices, and the mean over the length.",
        ),
    ]);
    page.figure(
        &lines(&chart("Line load along the bearing", "from the bearing's middle, mm", "N/mm"), &moments)?,
        "Normal force per length; uniform if shaft and bearing are aligned. tilt.csv contains every slice \
         over time.",
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use bench::plants::two_plane::SliceLoad;

    #[test]
    fn the_table_has_a_column_a_slice_and_the_edge_is_the_harder_end() {
        let slice = |line_load_n_m| SliceLoad { line_load_n_m, ..SliceLoad::default() };
        let sample = TwoPlaneSnapshot {
            planar: Default::default(),
            tilt_about_y_rad: 1e-3,
            tilt_about_z_rad: 0.0,
            moment_y_nm: 0.0,
            moment_z_nm: 0.0,
            slices: vec![slice(0.0), slice(1e3), slice(5e3)],
        };
        let text = to_csv(std::slice::from_ref(&sample), 1);
        let rows: Vec<Vec<&str>> = text.lines().map(|l| l.split(',').collect()).collect();
        assert_eq!((rows.len(), rows[0].len(), rows[1].len()), (2, 8, 8));
        assert_eq!((rows[0][7], rows[1][7]), ("line_load_3_n_m", "5e3"));
        assert_eq!((edge_load(&sample), mean_load(&sample)), (5e3, 2e3));
    }
}
