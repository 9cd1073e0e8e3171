//! `host-sim run --bench slider-crank`: the impacts of a slider-crank with a clearance joint.

use super::RunArgs;
use crate::cli::error::CliError;
use crate::cli::limits;
use crate::cli::output::Files;
use crate::run::summary::Sticking;
use bench::description::SliderCrankBench;
use bench::integrate::{ContactPlant, Impact, integrate};
use bench::simulate::impact_table;
use bench::simulate::peaks::{TIGHTER, impacts_with_bars};
use report::figure::{Chart, Series, lines};
use report::page::Page;
use report::text_table;
use schemars::JsonSchema;
use serde::Serialize;
use std::time::Instant;

/// Relative tolerance that keeps the slider's position within 1e-6 m over .6 revolutions.
const TOLERANCE: f64 = 1e-11;
/// Samples of a run.
const SAMPLES: usize = 4000;

/// Figures of a run.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(crate) struct SliderCrankSummary {
    /// Relative tolerance of the run.
    tolerance: f64,
    /// Wall time of the run, s.
    wall_s: f64,
    /// The same per simulated second.
    wall_s_per_simulated_s: f64,
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
    /// Times at which the contacts begin.
    onsets_s: Vec<f64>,
    /// Largest force of each contact.
    peaks_n: Vec<f64>,
    /// Numerical error bar of each peak, from two coarser tolerances; none for a contact that the
    /// finer of these runs does not have.
    error_bars_n: Vec<Option<f64>>,
    /// Sticking of the joint; absent with a friction law that does not stick.
    #[serde(skip_serializing_if = "Option::is_none")]
    sticking: Option<Sticking>,
    /// Terms of the energy balance in J, and its relative residual.
    energy: serde_json::Map<String, serde_json::Value>,
}

/// A row of the log: time, position, speed, deformation, contact force, friction force.
type Row = [f64; 6];

/// Runs the slider-crank and writes log.csv, impacts.csv, run.json and report.html.
pub(crate) fn run(bench: &SliderCrankBench, args: &RunArgs) -> Result<(), CliError> {
    let (summary, rows, impacts) = simulate(bench)?;
    let table = contact_rows(&summary, &impacts);
    let page = page(bench, &summary, &rows, &table).map_err(CliError::Work)?;
    let mut files = Files::new(&args.out);
    files.add("log.csv", &to_csv(&rows))?;
    let impacts = impact_table::to_csv(&impacts, bench.joint.latch_floor_m_s);
    files.add(impact_table::FILE_NAME, &impacts)?;
    let json = files.add_result("run.json", &summary)?;
    files.add_page("report.html", page)?;
    files.publish()?;
    if args.json {
        print_result!("{json}");
        return Ok(());
    }
    print_line!("{}", text_table(CONTACT_HEADER, &table, 0));
    print_line!(
        "slider at {:.10} m, {:.6} m/s\nrelative tolerance {:.0e}, {:.2} s of wall time per simulated \
         second\n\nreport: {}",
        summary.slider_position_m,
        summary.slider_speed_m_s,
        summary.tolerance,
        summary.wall_s_per_simulated_s,
        args.out.join("report.html").display()
    );
    Ok(())
}

fn simulate(bench: &SliderCrankBench) -> Result<(SliderCrankSummary, Vec<Row>, Vec<Impact>), CliError> {
    let plant = bench.plant();
    let end_s = bench.duration_s();
    let times: Vec<f64> = (0..SAMPLES).map(|i| end_s * i as f64 / SAMPLES as f64).collect();
    let mut rows = Vec::with_capacity(SAMPLES);
    let started = Instant::now();
    let result = integrate(
        &plant,
        (0.0, end_s),
        plant.initial_state(),
        false,
        &times,
        &plant.tolerances(TOLERANCE),
        |t, s, touch| {
            let normal_n = plant.normal_force_n(t, s, touch.latched_m_s);
            let forces = (normal_n, plant.friction_force_n(t, s, touch));
            rows.push([t, s[1], s[3], plant.deformation(t, s).0, forces.0, forces.1]);
        },
    )?;
    let wall_s = started.elapsed().as_secs_f64();
    let tolerances = plant.tolerances(TOLERANCE / TIGHTER);
    let bars = impacts_with_bars(&plant, (0.0, end_s), plant.initial_state(), &tolerances)?;
    let peaks_n: Vec<f64> = result.impacts.iter().map(|impact| impact.peak_force_n).collect();
    let [_, position, _, speed] = result.state;
    let energy = plant.audit(end_s, TOLERANCE)?.terms();
    let summary = SliderCrankSummary {
        tolerance: TOLERANCE,
        wall_s,
        wall_s_per_simulated_s: wall_s / end_s,
        contacts: peaks_n.len(),
        first_peak_n: peaks_n.first().copied().unwrap_or_default(),
        peak_contact_force_n: peaks_n.iter().copied().fold(0.0, f64::max),
        slider_position_m: position,
        slider_speed_m_s: speed,
        onsets_s: result.impacts.iter().map(|impact| impact.onset_s).collect(),
        peaks_n,
        sticking: Sticking::new(bench.friction.as_ref(), &result.impacts),
        energy: energy.map(|(name, value)| (name.to_owned(), value.into())).into_iter().collect(),
        error_bars_n: bars.iter().map(|(_, bar)| Some(*bar).filter(|b| b.is_finite())).collect(),
    };
    Ok((summary, rows, result.impacts))
}

fn to_csv(rows: &[Row]) -> String {
    let mut csv =
        String::from("t_s,position_m,velocity_m_s,deformation_m,contact_force_n,friction_force_n\n");
    for [t, x, v, d, normal, friction] in rows {
        csv.push_str(&format!("{t:e},{x:e},{v:e},{d:e},{normal:e},{friction:e}\n"));
    }
    csv
}

const CONTACT_HEADER: [&str; 4] = ["onset, us", "approach speed, m/s", "peak force, N", "error bar, N"];

fn contact_rows(summary: &SliderCrankSummary, impacts: &[Impact]) -> Vec<[String; 4]> {
    let row = |(impact, bar): (&Impact, &Option<f64>)| {
        [
            format!("{:.3}", impact.onset_s * 1e6),
            format!("{:.4}", impact.approach_speed_m_s),
            format!("{:.2}", impact.peak_force_n),
            bar.map_or_else(|| "unknown".into(), |bar| format!("{bar:.1e}")),
        ]
    };
    impacts.iter().zip(&summary.error_bars_n).map(row).collect()
}

/// Builds the page. An error describes a failure of drawing.
fn page(
    bench: &SliderCrankBench,
    summary: &SliderCrankSummary,
    rows: &[Row],
    table: &[[String; 4]],
) -> Result<Page, String> {
    let chart = |title, y| Chart { title, x: "time, s", y, size: (1040, 360) };
    let series = |name: &str, value: fn(&Row) -> f64| {
        Series::new(name, rows.iter().map(|r| r[0]), rows.iter().map(value))
    };
    let mut page = Page::new("Slider-crank with a clearance joint: one run");
    page.lead(&format!(
        "{} contacts in {} revolutions; first peak {:.2} N, largest {:.2} N.",
        summary.contacts, bench.crank.revolutions, summary.first_peak_n, summary.peak_contact_force_n
    ));
    page.figure(
        &lines(&chart("Contact force", "N"), &[series("force", |r| r[4])])?,
        "At the samples; the table contains the located peaks.",
    );
    page.figure(
        &lines(&chart("Slider speed", "m/s"), &[series("speed", |r| r[2])])?,
        "Every contact is a kink.",
    );
    let table: Vec<Vec<String>> = table.iter().map(|row| row.to_vec()).collect();
    page.section("Contacts").table(&CONTACT_HEADER, &table);
    page.note(
        "The error bar follows from runs at two coarser tolerances. impacts.csv contains every contact.",
    );
    limits::section(&mut page, bench);
    Ok(page)
}
