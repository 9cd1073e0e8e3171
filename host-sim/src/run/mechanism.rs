//! `host-sim run` with a mechanism: its contacts, drives and energy balance.

use super::RunArgs;
use super::force::ForceSource;
use super::magnitude::number;
use super::mechanism_networks::{self, NetworkFigures};
use super::mechanism_sketch::sketch;
use crate::cli::error::CliError;
use crate::cli::limits;
use crate::cli::output::Files;
use bench::description::MechanismBench;
use bench::plants::mechanism::Snapshot;
use bench::simulate::peaks::TIGHTER;
use bench::simulate::{RunWithBars, impact_table};
use report::figure::{Chart, Series, lines};
use report::page::Page;
use report::text_table;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;
use std::time::Instant;

/// Maximum number of curves in a chart.
const MAX_CURVES: usize = 6;

/// Figures of one contact.
#[derive(Clone, Debug, JsonSchema, Serialize)]
struct ContactSummary {
    /// Both bodies, with a number where a joint has several contacts.
    name: String,
    /// Periods in contact.
    impacts: usize,
    /// Share of the run in contact.
    share_of_time: f64,
    /// Largest normal force.
    peak_force_n: f64,
    /// Its numerical error bar, from three tolerances, or with networks from three communication
    /// steps; none if the coarser runs lack the impact.
    error_bar_n: Option<f64>,
    /// Time of the largest force.
    peak_s: f64,
    /// Largest deformation.
    max_deformation_m: f64,
}

/// Figures of a run.
#[derive(Clone, Debug, JsonSchema, Serialize)]
pub(crate) struct MechanismSummary {
    /// Source of the forces of the contacts with networks; those of the others come from laws.
    force: ForceSource,
    /// Figures of the networks; none with laws alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    networks: Option<NetworkFigures>,
    contacts: Vec<ContactSummary>,
    /// Largest magnitude of each drive's force or torque at the log's rows, by name with unit.
    drive_peaks: BTreeMap<String, f64>,
    /// Centre of mass in m and angle in rad of each body at the end.
    end: BTreeMap<String, [f64; 3]>,
    /// Energy balance, J.
    energy: BTreeMap<String, f64>,
    /// Residual of the energy balance relative to the work.
    energy_residual_rel: f64,
    steps: usize,
    /// Relative tolerance of the run that the figures show.
    tolerance: f64,
    /// Wall time of the three runs, s.
    wall_s: f64,
}

/// Runs the mechanism and writes log.csv, impacts.csv, run.json and report.html.
pub(crate) fn run(bench: &MechanismBench, args: &RunArgs) -> Result<(), CliError> {
    let count = bench.run.samples;
    let times: Vec<f64> =
        (0..count).map(|i| bench.run.duration_s * f64::from(i) / f64::from(count)).collect();
    let source = mechanism_networks::source(bench, args)?;
    let started = Instant::now();
    let (result, networks) = if source == ForceSource::Law {
        (bench.simulate_with_bars(&times)?, None)
    } else {
        let (result, networks) = mechanism_networks::run(bench, (source, args.step_us), &times)?;
        (result, Some(networks))
    };
    let mut summary = summary(bench, &result, started.elapsed().as_secs_f64());
    if networks.is_some() {
        (summary.force, summary.networks, summary.tolerance) = (source, networks, bench.run.tolerance);
    }
    let page = page(bench, &summary, &result).map_err(CliError::Work)?;
    let floors = bench.latch_floors_m_s();
    let floor = |contact: usize| floors.get(contact).copied().unwrap_or_default();
    let mut files = Files::new(&args.out);
    files.add("log.csv", &to_csv(bench, &result.run.samples))?;
    let impacts = impact_table::to_csv_with_floors(&result.run.impacts, floor);
    files.add(impact_table::FILE_NAME, &impacts)?;
    let json = files.add_result("run.json", &summary)?;
    files.add_page("report.html", page)?;
    files.publish()?;
    if args.json {
        print_result!("{json}");
        return Ok(());
    }
    print_line!("{}", text_table(CONTACT_HEADER, contact_rows(&summary), 1));
    for (drive, peak) in &summary.drive_peaks {
        print_line!("largest drive {drive}: {peak:.4}");
    }
    print_line!(
        "energy residual {:.1e} of the work\n\nreport: {}",
        summary.energy_residual_rel,
        args.out.join("report.html").display()
    );
    Ok(())
}

fn summary(bench: &MechanismBench, result: &RunWithBars, wall_s: f64) -> MechanismSummary {
    let run = &result.run;
    let drive_peak = |i: usize| {
        run.samples.iter().filter_map(|s| s.drives.get(i)).fold(0.0, |max: f64, force| max.max(force.abs()))
    };
    let drives = bench.drive_names().into_iter().enumerate();
    let bodies = bench.body.iter().zip(&run.end.bodies);
    let energy = run.energy.terms().map(|(name, value)| (name.to_owned(), value));
    MechanismSummary {
        force: ForceSource::Law,
        networks: None,
        contacts: contacts(bench, result),
        drive_peaks: drives.map(|(i, (name, unit))| (format!("{name}_{unit}"), drive_peak(i))).collect(),
        end: bodies.map(|(body, state)| (body.name.clone(), state.position)).collect(),
        energy: energy.into_iter().collect(),
        energy_residual_rel: run.energy.residual_rel(),
        steps: run.steps,
        tolerance: bench.run.tolerance * TIGHTER,
        wall_s,
    }
}

fn contacts(bench: &MechanismBench, RunWithBars { run, bars_n }: &RunWithBars) -> Vec<ContactSummary> {
    let of_contact = |(contact, name): (usize, String)| {
        let own = || run.impacts.iter().zip(bars_n).filter(move |(impact, _)| impact.contact == contact);
        let touching_s: f64 =
            own().map(|(i, _)| i.separation_s.unwrap_or(bench.run.duration_s) - i.onset_s).sum();
        let highest = own().max_by(|(a, _), (b, _)| a.peak_force_n.total_cmp(&b.peak_force_n));
        ContactSummary {
            name,
            impacts: own().count(),
            share_of_time: touching_s / bench.run.duration_s,
            peak_force_n: highest.map_or(0.0, |(impact, _)| impact.peak_force_n),
            error_bar_n: highest.map(|(_, bar)| *bar).filter(|bar| bar.is_finite()),
            peak_s: highest.map_or(0.0, |(impact, _)| impact.peak_s),
            max_deformation_m: own().map(|(i, _)| i.max_deformation_m).fold(0.0, f64::max),
        }
    };
    bench.contact_names().into_iter().enumerate().map(of_contact).collect()
}

fn to_csv(bench: &MechanismBench, samples: &[Snapshot]) -> String {
    let header: Vec<String> = std::iter::once("t_s".to_owned()).chain(bench.columns()).collect();
    let mut csv = header.join(",");
    csv.push('\n');
    for sample in samples {
        let values = std::iter::once(sample.time_s).chain(sample.row());
        let row: Vec<String> = values.map(|value| format!("{value:e}")).collect();
        csv.push_str(&row.join(","));
        csv.push('\n');
    }
    csv
}

const CONTACT_HEADER: [&str; 5] = ["contact", "impacts", "in contact, %", "peak force, N", "error bar, N"];

fn contact_rows(summary: &MechanismSummary) -> Vec<[String; 5]> {
    let row = |contact: &ContactSummary| {
        [
            contact.name.clone(),
            contact.impacts.to_string(),
            format!("{:.1}", 100.0 * contact.share_of_time),
            format!("{:.2}", contact.peak_force_n),
            contact.error_bar_n.map_or_else(|| "unknown".into(), |bar| format!("{bar:.1e}")),
        ]
    };
    summary.contacts.iter().map(row).collect()
}

/// Builds the page. An error describes a failure of drawing.
fn page(bench: &MechanismBench, summary: &MechanismSummary, result: &RunWithBars) -> Result<Page, String> {
    let samples = &result.run.samples;
    let curve = |name: String, value: &dyn Fn(&Snapshot) -> f64| {
        Series::new(name, samples.iter().map(|s| s.time_s), samples.iter().map(value))
    };
    let mut page = Page::new("Mechanism: one run");
    page.lead(&format!(
        "{} bodies, {} contacts, {} s; energy residual {:.1e} of the work. Contacts and drives are named \
         after their bodies.",
        bench.body.len(),
        summary.contacts.len(),
        number(bench.run.duration_s),
        summary.energy_residual_rel
    ));
    if let Some(sketch) = sketch(bench, samples) {
        page.animation(
            &sketch.svg,
            &sketch.frames,
            "Sketch of the run; arrows are the forces of clearance joints on their journals.",
        );
    }
    let names = bench.contact_names().into_iter().enumerate().take(MAX_CURVES);
    let forces: Vec<Series> =
        names.map(|(i, name)| curve(name, &|s| s.contacts.get(i).map_or(0.0, |c| c.normal_n))).collect();
    if !forces.is_empty() {
        let chart = Chart { title: "Contact force", x: "time, s", y: "normal force, N", size: (1040, 360) };
        page.figure(&lines(&chart, &forces)?, "At the log's rows; the table contains the located peaks.");
    }
    for (i, (name, unit)) in bench.drive_names().into_iter().enumerate().take(MAX_CURVES) {
        let y = if unit == "n" { "force, N" } else { "torque, N m" };
        let chart = Chart { title: &format!("Drive {name}"), x: "time, s", y, size: (1040, 300) };
        let force = curve(name, &|s| s.drives.get(i).copied().unwrap_or_default());
        page.figure(&lines(&chart, &[force])?, "Force of the drive's constraint on the second body.");
    }
    let angles = bench.body.iter().enumerate().take(MAX_CURVES).map(|(i, body)| {
        curve(body.name.clone(), &|s| s.bodies.get(i).map_or(0.0, |state| state.position[2]))
    });
    let chart = Chart { title: "Angles", x: "time, s", y: "angle, rad", size: (1040, 300) };
    page.figure(&lines(&chart, &angles.collect::<Vec<_>>())?, "Angles of the bodies.");
    let rows: Vec<Vec<String>> = contact_rows(summary).into_iter().map(Vec::from).collect();
    page.section("Contacts").table(&CONTACT_HEADER, &rows);
    page.note(
        "The error bar follows from runs at three tolerances, or with networks at three communication \
         steps, and their observed order of convergence. impacts.csv contains every impact.",
    );
    let terms = result.run.energy.terms();
    let rows: Vec<Vec<String>> =
        terms.iter().map(|(name, value)| vec![(*name).into(), number(*value)]).collect();
    page.section("Energy balance").table(&["term", "value"], &rows);
    limits::section(&mut page, bench);
    Ok(page)
}
