//! Figures of each cycle of a run of the transmission bench.

use super::course::Course;
use crate::plants::transmission::Snapshot;
use crate::statistics::{Band, rms};

/// Edges of the bands of oscillation in Hz: half decades.
const EDGES_HZ: [f64; 7] = [3.0, 10.0, 30.0, 100.0, 300.0, 1000.0, 3000.0];

/// A quantity with one value per cycle.
#[derive(Clone, Debug)]
pub(super) struct Column {
    /// Name, unit included.
    pub(super) name: String,
    /// Values by cycle.
    pub(super) values: Vec<f64>,
    /// Kind.
    pub(super) kind: Kind,
}

/// Kind of a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Largest magnitude of a cycle.
    Peak,
    /// Any other figure.
    Plain,
}

/// Boundaries of the complete cycles as indices of samples: one more than there are cycles.
pub(super) fn boundaries(course: &Course<'_>) -> Vec<usize> {
    let samples = course.samples;
    let start_s = samples.first().map_or(0.0, |s| s.time_s);
    let count = ((course.end_s - start_s) / course.cycle_s + 1e-9).floor().max(0.0) as usize;
    // Half a sample interval absorbs the rounding of the times.
    let half_s = 0.5 / course.rate_hz;
    let at = |k: usize| start_s + k as f64 * course.cycle_s - half_s;
    (0..=count).map(|k| samples.partition_point(|s| s.time_s < at(k))).collect()
}

/// All quantities of the cycles between some boundaries.
pub(super) fn columns(course: &Course<'_>, boundaries: &[usize]) -> Vec<Column> {
    let force: Vec<f64> = course.samples.iter().map(|s| s.forces.normal_n).collect();
    let rms_of_cycles = |history: &[f64]| {
        per_cycle(boundaries, |from, to| rms(history.get(from..to).unwrap_or_default().iter().copied()))
    };
    let mut columns = vec![
        peak(course, boundaries, "peak_contact_force_n", |s| s.forces.normal_n),
        peak(course, boundaries, "peak_friction_torque_nm", |s| s.friction_torque_nm),
        peak(course, boundaries, "peak_drive_force_n", |s| s.drive_force_n),
    ];
    let all = Band { low_hz: EDGES_HZ[0], high_hz: f64::INFINITY };
    columns.push(Column::plain("oscillation_rms_n", rms_of_cycles(&all.filter(&force, course.rate_hz))));
    for edges in EDGES_HZ.windows(2) {
        let &[low_hz, high_hz] = edges else { continue };
        let band = Band { low_hz, high_hz };
        let name = format!("oscillation_{low_hz}_{high_hz}_hz_n");
        columns.push(Column::plain(&name, rms_of_cycles(&band.filter(&force, course.rate_hz))));
    }
    columns.push(Column::plain(
        "without_contact_share",
        per_cycle(boundaries, |from, to| {
            let part = course.samples.get(from..to).unwrap_or_default();
            let free = part.iter().filter(|s| s.contact.deformation_m <= 0.0).count();
            free as f64 / part.len().max(1) as f64
        }),
    ));
    let onset = |index: usize| course.samples.get(index).map_or(course.end_s, |s| s.time_s);
    columns.push(Column::plain(
        "contacts",
        per_cycle(boundaries, |from, to| {
            let within = |i: &&crate::integrate::Impact| (onset(from)..onset(to)).contains(&i.onset_s);
            course.impacts.iter().filter(within).count() as f64
        }),
    ));
    let [friction, damping, load_friction] = [0, 1, 2]
        .map(|part| per_cycle(boundaries, |from, to| course.loss(to, part) - course.loss(from, part)));
    let sum = friction.iter().zip(&damping).zip(&load_friction).map(|((a, b), c)| a + b + c).collect();
    columns.push(Column::plain("friction_heat_j", friction));
    columns.push(Column::plain("damping_loss_j", damping));
    columns.push(Column::plain("load_friction_heat_j", load_friction));
    columns.push(Column::plain("dissipated_j", sum));
    columns
}

impl Column {
    fn plain(name: &str, values: Vec<f64>) -> Self {
        Self { name: name.into(), values, kind: Kind::Plain }
    }
}

/// Largest magnitude in each cycle; in the first one from the end of the load's ramp on.
fn peak(course: &Course<'_>, boundaries: &[usize], name: &str, read: fn(&Snapshot) -> f64) -> Column {
    let values = per_cycle(boundaries, |from, to| {
        let part = course.samples.get(from..to).unwrap_or_default();
        let counted = part.iter().filter(|s| s.time_s >= course.counted_from_s);
        counted.map(|s| read(s).abs()).fold(0.0, f64::max)
    });
    Column { name: name.into(), values, kind: Kind::Peak }
}

fn per_cycle(boundaries: &[usize], figure: impl Fn(usize, usize) -> f64) -> Vec<f64> {
    boundaries.windows(2).map(|pair| if let &[from, to] = pair { figure(from, to) } else { 0.0 }).collect()
}
