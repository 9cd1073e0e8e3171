//! `host-sim run --bench slider-crank`: the impacts of a slider-crank with a clearance joint.

use super::limits;
use super::run::RunArgs;
use crate::error::CliError;
use crate::figure::{Chart, Series, lines};
use crate::page::Page;
use bench::integrate::{ContactPlant, Impact, integrate};
use bench::peaks::{TIGHTER, impacts_with_bars};
use bench::slider_crank_description::SliderCrankBench;
use bench::{atomic, impact_log};
use serde::Serialize;

/// Relative tolerance that keeps the slider's position within 1e-6 m over .6 revolutions.
const TOLERANCE: f64 = 1e-11;
/// Samples of a run.
const SAMPLES: usize = 4000;

/// What a run came to.
#[derive(Clone, Debug, Serialize)]
pub(super) struct SliderCrankSummary {
    /// Periods in contact.
    contacts: usize,
    /// Largest force of the first contact.
    first_peak_n: f64,
    /// Largest force of all.
    peak_contact_force_n: f64,
    /// Slider position at the end.
    slider_position_m: f64,
    /// Slider speed at the end.
    slider_speed_m_s: f64,
    /// Onsets.
    onsets_s: Vec<f64>,
    /// Largest force of each contact.
    peaks_n: Vec<f64>,
    /// Numerical error bar of each, from a coarser tolerance; none for a contact that the coarser run does not have.
    error_bars_n: Vec<Option<f64>>,
}

/// Runs the slider-crank and writes log.csv, impacts.csv, run.json and report.html.
pub(super) fn run(bench: &SliderCrankBench, args: &RunArgs) -> Result<(), CliError> {
    let plant = bench.plant();
    let end_s = bench.duration_s();
    let times: Vec<f64> = (0..SAMPLES).map(|i| end_s * i as f64 / SAMPLES as f64).collect();
    let mut rows = Vec::with_capacity(SAMPLES);
    let result = integrate(
        &plant,
        (0.0, end_s),
        plant.initial_state(),
        false,
        &times,
        &plant.tolerances(TOLERANCE),
        |t, s, latched| {
            rows.push((t, s[1], s[3], plant.deformation(t, s).0, plant.normal_force_n(t, s, latched)));
        },
    )?;
    let tolerances = plant.tolerances(TOLERANCE / TIGHTER);
    let bars = impacts_with_bars(&plant, (0.0, end_s), plant.initial_state(), &tolerances)?;
    let error_bars_n: Vec<Option<f64>> =
        bars.iter().map(|(_, bar)| Some(*bar).filter(|b| b.is_finite())).collect();
    let peaks_n: Vec<f64> = result.impacts.iter().map(|i: &Impact| i.peak_force_n).collect();
    let [_, position, _, speed] = result.state;
    let summary = SliderCrankSummary {
        contacts: peaks_n.len(),
        first_peak_n: peaks_n.first().copied().unwrap_or_default(),
        peak_contact_force_n: peaks_n.iter().copied().fold(0.0, f64::max),
        slider_position_m: position,
        slider_speed_m_s: speed,
        onsets_s: result.impacts.iter().map(|i| i.onset_s).collect(),
        peaks_n,
        error_bars_n,
    };
    let mut csv = String::from("t_s,position_m,velocity_m_s,deformation_m,contact_force_n\n");
    for (t, x, v, d, f) in &rows {
        csv.push_str(&format!("{t:e},{x:e},{v:e},{d:e},{f:e}\n"));
    }
    let chart = |title, y| Chart { title, x: "time, s", y, size: (1040, 360) };
    let series = |name: &str, value: fn(&(f64, f64, f64, f64, f64)) -> f64| {
        Series::new(name, rows.iter().map(|r| r.0), rows.iter().map(value))
    };
    let mut page = Page::new("Slider-crank with a clearance joint: one run");
    page.lead(&format!(
        "{} contacts in {} revolutions; first peak {:.2} N, largest {:.2} N.",
        summary.contacts, bench.crank.revolutions, summary.first_peak_n, summary.peak_contact_force_n
    ));
    let table: Vec<Vec<String>> = result
        .impacts
        .iter()
        .zip(&summary.error_bars_n)
        .map(|(i, bar)| {
            vec![
                format!("{:.3}", i.onset_s * 1e6),
                format!("{:.4}", i.approach_speed_m_s),
                format!("{:.2}", i.peak_force_n),
                bar.map_or_else(|| "unknown".into(), |bar| format!("{bar:.1e}")),
            ]
        })
        .collect();
    page.figure(
        &lines(&chart("Contact force", "N"), &[series("force", |r| r.4)]).map_err(CliError::Work)?,
        "At the samples; the table has the located peaks.",
    );
    page.figure(
        &lines(&chart("Slider speed", "m/s"), &[series("speed", |r| r.2)]).map_err(CliError::Work)?,
        "Every contact is a kink.",
    );
    page.section("Contacts")
        .table(&["onset, us", "approach speed, m/s", "peak force, N", "error bar, N"], &table);
    page.note("The error bar is the distance from a run at a coarser tolerance; impacts.csv has more of each contact.");
    limits::section(&mut page, "slider-crank");
    let json = serde_json::to_string_pretty(&summary).map_err(|e| CliError::Work(e.to_string()))?;
    let impacts = impact_log::to_csv(&result.impacts, bench.joint.latch_floor_m_s);
    for (name, text) in [
        ("log.csv", csv),
        (impact_log::FILE_NAME, impacts),
        ("run.json", format!("{json}\n")),
        ("report.html", page.render()),
    ] {
        let path = args.out.join(name);
        atomic::write(&path, text.as_bytes()).map_err(|e| CliError::output(&path, &e))?;
    }
    if args.json {
        say!("{json}");
    } else {
        say!("{:>12} {:>12} {:>14} {:>12}", "onset, us", "speed, m/s", "peak force, N", "error bar, N");
        for row in &table {
            say!("{:>12} {:>12} {:>14} {:>12}", row[0], row[1], row[2], row[3]);
        }
        say!(
            "slider at {position:.10} m, {speed:.6} m/s\n\nreport: {}",
            args.out.join("report.html").display()
        );
    }
    Ok(())
}
