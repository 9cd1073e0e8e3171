//! `host-sim sweep latch`: what the speed in the damping does to the peak force.
//!
//! The damping multiplies the elastic force by `1 + chi q`. In sustained contact the printed form, `q = d'/d'0` with the
//! speed latched at an onset long ago or a floor, hangs on a number of the model, not of the bench. This sweep shows how
//! much: the latched form at five floors, the same with `q` held to -1..1, and the sustained form `q = d'/v_r` at the
//! same speeds, all with the analytic law under error control.

use super::limits;
use super::output::{self, Picture};
use super::sweep::RunOptions;
use crate::error::CliError;
use crate::figure::{Chart, Series, Style, lines_log_x};
use crate::force::{self, DEFAULT_STEP_S, ForceSource, SAMPLE_RATE_HZ};
use crate::page::Page;
use crate::paper::{BEARINGS, CLEARANCES_MM, resolved, variant};
use crate::summary::{ErrorBars, Figures};
use crate::sweep::table;
use crate::{parallel, progress};
use bench::BearingMaterial;
use bench::description::TransmissionBench;
use bench::transmission::Transmission;
use contact::Damping;
use serde::Serialize;
use serde::de::{Deserialize, IntoDeserializer, value};
use std::path::Path;

/// Floors and reference speeds, mm/s.
const SPEEDS_MM_S: [f64; 5] = [1.0, 5.0, 10.0, 50.0, 200.0];
/// Load of the runs, kN.
const LOAD_KN: f64 = 10.0;

/// One run.
#[derive(Clone, Debug, Serialize)]
struct LatchRun {
    /// `latched`, `bounded` or `reference`.
    damping: &'static str,
    /// Floor of the latched approach speed, or the reference speed.
    speed_mm_s: f64,
    /// Speed at which the journal lands at the start; a floor below it does nothing.
    landing_speed_mm_s: f64,
    /// Peak force over that of the latched form with the smallest floor, less one.
    peak_change: f64,
    /// The usual figures.
    #[serde(flatten)]
    figures: Figures,
}

#[derive(Serialize)]
struct Outcome {
    runs: Vec<LatchRun>,
}

/// Runs the forms and writes runs.csv, sweep.json, pictures and report.html.
pub(super) fn run(options: &RunOptions, folder: &Path, json: bool) -> Result<(), CliError> {
    if let Some(source) = options.force.filter(|s| *s != ForceSource::Law) {
        return Err(CliError::Input(format!(
            "--force: found {}; expected law: the networks were trained with one form and floor",
            source.name()
        )));
    }
    let base = options.base()?;
    options.step_s()?;
    output::ready(folder)?;
    let mut cases = Vec::new();
    for bearing in BEARINGS {
        for clearance in CLEARANCES_MM {
            for damping in Damping::<f64>::NAMES {
                cases.extend(SPEEDS_MM_S.map(|speed| (bearing, clearance, damping, speed)));
            }
        }
    }
    let bar = progress::bar(json, cases.len() as u64);
    bar.set_message("forms of the damping");
    let mut runs = parallel::map(options.threads, &cases, |_, case| {
        let run = one(&base, *case);
        bar.inc(1);
        run
    })?;
    bar.finish_and_clear();
    for group in runs.chunks_mut(SPEEDS_MM_S.len() * Damping::<f64>::NAMES.len()) {
        let first = group.first().map_or(1.0, |r| r.figures.peak_contact_force_n);
        group.iter_mut().for_each(|r| r.peak_change = r.figures.peak_contact_force_n / first - 1.0);
    }
    let outcome = Outcome { runs };
    let text = output::json(&outcome)?;
    let pictures = pictures(&outcome.runs)?;
    output::write(folder, "runs.csv", &table::csv(&outcome.runs)?)?;
    output::write(folder, "sweep.json", &format!("{text}\n"))?;
    output::save(folder, &pictures)?;
    output::write(folder, "report.html", &page(&outcome.runs, &pictures, limits::plant_of(&base)).render())?;
    if json {
        say!("{text}");
    } else {
        let line = |cells: &[String]| cells.iter().map(|c| format!("{c:>13}")).collect::<Vec<_>>().join(" ");
        say!("peak contact force in N by floor or reference speed");
        say!("{}", line(&header()));
        rows(&outcome.runs).iter().for_each(|row| say!("{}", line(row)));
        say!("{}", ErrorBars::largest(outcome.runs.iter().map(|r| &r.figures)));
        say!("\nreport: {}", folder.join("report.html").display());
    }
    Ok(())
}

fn one(
    base: &TransmissionBench,
    (bearing, clearance_mm, damping, speed_mm_s): (BearingMaterial, f64, &'static str, f64),
) -> Result<LatchRun, CliError> {
    let mut bench = variant(base, bearing, clearance_mm, LOAD_KN);
    bench.contact.latch_floor_m_s = speed_mm_s * 1e-3;
    bench.contact.damping = Deserialize::deserialize(damping.into_deserializer())
        .map_err(|e: value::Error| CliError::Work(format!("{damping}: {e}")))?;
    let bench = resolved(bench)?;
    let plant = Transmission::new(&bench, bench.drive_profile(), bench.load_profile());
    let forced = force::run_bench(&bench, ForceSource::Law, DEFAULT_STEP_S, || {})?;
    Ok(LatchRun {
        damping,
        speed_mm_s,
        landing_speed_mm_s: plant.landing_speed_m_s() * 1e3,
        peak_change: 0.0,
        figures: Figures::of(&bench, ForceSource::Law, &forced, SAMPLE_RATE_HZ),
    })
}

fn header() -> Vec<String> {
    let speeds = SPEEDS_MM_S.iter().map(|s| format!("{s:.0} mm/s"));
    ["bearing", "clearance, mm", "damping"].into_iter().map(String::from).chain(speeds).collect()
}

/// Peak forces, a row a bearing, clearance and form.
fn rows(runs: &[LatchRun]) -> Vec<Vec<String>> {
    runs.chunks(SPEEDS_MM_S.len())
        .filter_map(|group| {
            let first = group.first()?;
            let start = [
                first.figures.bearing.name().to_owned(),
                format!("{:.2}", first.figures.clearance_mm),
                first.damping.to_owned(),
            ];
            let peaks = group.iter().map(|r| format!("{:.0}", r.figures.peak_contact_force_n));
            Some(start.into_iter().chain(peaks).collect())
        })
        .collect()
}

fn pictures(runs: &[LatchRun]) -> Result<Vec<Picture>, CliError> {
    let mut pictures = Vec::new();
    for (damping, axis, caption) in [
        ("latched", "floor of the approach speed, mm/s", "As printed: rate over latched approach speed."),
        ("bounded", "floor of the approach speed, mm/s", "The same with the ratio held to -1..1."),
        ("reference", "reference speed, mm/s", "Sustained form: rate over a constant speed, no latch."),
    ] {
        for bearing in BEARINGS {
            let series = CLEARANCES_MM.map(|clearance| {
                let of = |r: &&LatchRun| {
                    r.figures.bearing == bearing
                        && r.damping == damping
                        && (r.figures.clearance_mm - clearance).abs() < 1e-9
                };
                let points = runs.iter().filter(of).map(|r| (r.speed_mm_s, 100.0 * r.peak_change)).collect();
                Series::through(format!("{clearance} mm"), points).styled(Style::Both)
            });
            let title = format!("Peak force, {damping} damping, {}", bearing.name());
            let chart = Chart { title: &title, x: axis, y: "change, %", size: (512, 320) };
            let name = format!("latch-{}-{damping}", bearing.name());
            pictures.push(Picture::draw(lines_log_x, &name, &chart, &series, caption)?);
        }
    }
    Ok(pictures)
}

fn page(runs: &[LatchRun], pictures: &[Picture], plant: &str) -> Page {
    let mut page = Page::new("The speed in the damping");
    let span = |damping: &str| {
        let changes = || runs.iter().filter(|r| r.damping == damping).map(|r| 100.0 * r.peak_change);
        let (low, high) =
            (changes().fold(f64::INFINITY, f64::min), changes().fold(f64::NEG_INFINITY, f64::max));
        format!("{low:+.0} to {high:+.0} %")
    };
    page.lead(&format!(
        "Between 1 and 200 mm/s the floor of the latched approach speed moves the peak force by {}, with nothing else \
         changed; the bounded form by {}, the sustained form by {}.",
        span("latched"),
        span("bounded"),
        span("reference")
    ));
    page.note(
        "Changes are against the latched form with a floor of 1 mm/s. With a latch the damping is scaled with the speed \
         at which the journal landed at the start, or with the floor where that is larger: a floor below the landing \
         speed does nothing. Where the bench then stays in contact, a floor above the landing speed is the same as the \
         sustained form with that speed, so the sustained form does not lessen what hangs on the number: it only makes it \
         a constant of the bearing instead of an accident of the landing.",
    );
    output::show(&mut page, pictures);
    page.section("Peak contact force, N, by floor or reference speed");
    let header = header();
    page.table(&header.iter().map(String::as_str).collect::<Vec<_>>(), &rows(runs));
    page.note(&format!("Here {}. runs.csv has each.", ErrorBars::largest(runs.iter().map(|r| &r.figures))));
    limits::section(&mut page, plant);
    page
}
