//! Motion of the drive: its course, and order and position of a rudder servo.

use super::magnitude::rms;
use bench::description::TransmissionBench;
use bench::plants::transmission::Snapshot;
use report::figure::{Chart, Series, lines};
use report::page::Page;
use schemars::JsonSchema;
use serde::Serialize;

/// Points of a curve in a picture.
const POINTS: usize = 4000;

/// Position error of the servo: order less position of the fork.
#[derive(Clone, Copy, Debug, JsonSchema, Serialize)]
pub struct ServoFigures {
    /// Rms over the run.
    pub rms_error_m: f64,
    /// Largest magnitude.
    pub largest_error_m: f64,
}

impl ServoFigures {
    /// Compares order and position; none without a servo.
    pub(crate) fn from_run(bench: &TransmissionBench, samples: &[Snapshot]) -> Option<Self> {
        bench.servo.as_ref()?;
        let order = bench.drive_profile();
        let errors: Vec<f64> = samples.iter().map(|s| order.at(s.time_s).value - s.drive.value).collect();
        Some(Self {
            rms_error_m: rms(errors.iter().copied()),
            largest_error_m: errors.iter().fold(0.0, |most, error| error.abs().max(most)),
        })
    }
}

/// Adds the section with the motion of the drive.
pub(crate) fn motion_section(
    page: &mut Page,
    bench: &TransmissionBench,
    samples: &[Snapshot],
) -> Result<(), String> {
    page.section("Drive");
    let thinned = || samples.iter().step_by((samples.len() / POINTS).max(1));
    let mut curves = Vec::new();
    if bench.servo.is_some() {
        let order = bench.drive_profile();
        curves.push(Series::through(
            "order",
            thinned().map(|s| (s.time_s, 1e3 * order.at(s.time_s).value)).collect(),
        ));
    }
    let name = if bench.servo.is_some() { "position of the fork" } else { "displacement" };
    curves.push(Series::through(name, thinned().map(|s| (s.time_s, 1e3 * s.drive.value)).collect()));
    let chart = Chart { title: "Motion of the drive", x: "time, s", y: "mm", size: (1040, 300) };
    page.figure(&lines(&chart, &curves)?, "Displacement of the fork along Y.");
    Ok(())
}
