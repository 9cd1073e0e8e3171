//! `host-sim sweep latch`: effect of the speed in the damping on the peak force.
//!
//! The damping multiplies the elastic force by `1 + chi q`. The printed form is `q = d'/d'0`, with
//! the approach speed latched at the onset, or a floor. In sustained contact it depends on a number
//! of the model, not of the bench. This sweep compares the latched form at five floors, the same
//! with `q` limited to -1..1, and the sustained form `q = d'/v_r` at the same speeds, all with the
//! analytic law under error control.

use super::options::SweepOptions;
use super::owner;
use super::table;
use crate::cli::error::CliError;
use crate::cli::limits;
use crate::cli::output::{self, Files, Picture};
use crate::cli::{parallel, progress};
use crate::run::conditions::{BEARINGS, CLEARANCES_MM, variant};
use crate::run::force::{self, DEFAULT_STEP_S, ForceSource, SAMPLE_RATE_HZ};
use crate::run::summary::{Figures, PerPeak};
use bench::BearingMaterial;
use bench::description::TransmissionBench;
use bench::plants::transmission::Transmission;
use contact::Damping;
use report::figure::{Chart, Series, Style, lines_log_x};
use report::page::Page;
use report::text_table;
use schemars::JsonSchema;
use serde::Serialize;
use serde::de::{Deserialize, IntoDeserializer, value};
use std::path::Path;

/// Floors and reference speeds, mm/s.
const SPEEDS_MM_S: [f64; 5] = [1.0, 5.0, 10.0, 50.0, 200.0];
/// Load of the runs, kN.
const LOAD_KN: f64 = 10.0;

/// One run.
#[derive(Clone, Debug, Serialize, JsonSchema)]
struct LatchRun {
    /// `latched`, `bounded` or `reference`.
    damping: &'static str,
    /// Floor of the latched approach speed, or the reference speed.
    speed_mm_s: f64,
    /// Speed at which the journal lands at the start; a lower floor has no effect.
    landing_speed_mm_s: f64,
    /// Relative change of the peak force from the latched form with the smallest floor.
    peak_change: f64,
    /// The usual figures.
    #[serde(flatten)]
    figures: Figures,
}

#[derive(Serialize, JsonSchema)]
pub(crate) struct Outcome {
    sweep: &'static str,
    runs: Vec<LatchRun>,
}

/// Name of the sweep in its results.
const NAME: &str = "latch";

/// Runs the forms and writes runs.csv, sweep.json, pictures and report.html.
pub(crate) fn run(options: &SweepOptions, folder: &Path, json: bool) -> Result<(), CliError> {
    if let Some(source) = options.force.filter(|s| *s != ForceSource::Law) {
        return Err(CliError::Input(format!(
            "--force: found {}; expected law: the networks were trained with one form and floor",
            source.name()
        )));
    }
    let base = options.base()?;
    options.step_s()?;
    output::check_folder(folder)?;
    owner::check(folder, NAME)?;
    let mut cases = Vec::new();
    for bearing in BEARINGS {
        for clearance in CLEARANCES_MM {
            for damping in Damping::<f64>::NAMES {
                cases.extend(SPEEDS_MM_S.map(|speed| (bearing, clearance, damping, speed)));
            }
        }
    }
    let bar = progress::bar(cases.len() as u64);
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
    let outcome = Outcome { sweep: NAME, runs };
    let pictures = pictures(&outcome.runs)?;
    let mut files = Files::new(folder);
    files.add("runs.csv", &table::csv(&outcome.runs)?)?;
    let text = files.add_result("sweep.json", &outcome)?;
    files.add_pictures(&pictures)?;
    files.add_page("report.html", page(&outcome.runs, &pictures, &base))?;
    files.publish()?;
    if json {
        print_result!("{text}");
    } else {
        print_line!("peak contact force in N by floor or reference speed");
        print_line!("{}", text_table(header(), rows(&outcome.runs), 1));
        print_line!("{}", PerPeak::largest_bars(outcome.runs.iter().map(|r| &r.figures)));
        print_line!("\nreport: {}", folder.join("report.html").display());
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
    let bench = bench.resolved();
    let plant = Transmission::new(&bench, bench.drive_profile(), bench.load_profile());
    let forced = force::run_bench(&bench, ForceSource::Law, DEFAULT_STEP_S, || {})?;
    Ok(LatchRun {
        damping,
        speed_mm_s,
        landing_speed_mm_s: plant.landing_speed_m_s() * 1e3,
        peak_change: 0.0,
        figures: Figures::from_run(&bench, ForceSource::Law, &forced, SAMPLE_RATE_HZ),
    })
}

fn header() -> Vec<String> {
    let speeds = SPEEDS_MM_S.iter().map(|s| format!("{s:.0} mm/s"));
    ["bearing", "clearance, mm", "damping"].into_iter().map(String::from).chain(speeds).collect()
}

/// Peak forces: one row per bearing, clearance and form.
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

fn page(runs: &[LatchRun], pictures: &[Picture], base: &TransmissionBench) -> Page {
    let mut page = Page::new("Speed in the damping");
    let span = |damping: &str| {
        let changes = || runs.iter().filter(|r| r.damping == damping).map(|r| 100.0 * r.peak_change);
        let (low, high) =
            (changes().fold(f64::INFINITY, f64::min), changes().fold(f64::NEG_INFINITY, f64::max));
        format!("{low:+.0} to {high:+.0} %")
    };
    page.lead(&format!(
        "A floor of 1 to 200 mm/s for the latched approach speed changes the peak force by {}, in the \
         bounded form by {}, in the sustained form by {}.",
        span("latched"),
        span("bounded"),
        span("reference")
    ));
    page.note(
        "Changes are relative to the latched form with a floor of 1 mm/s. The latch scales the damping by \
         the landing speed at the start, or by the floor if that is larger, so a floor below the landing \
         speed has no effect. If the bench then stays in contact, a floor above the landing speed equals \
         the sustained form with that speed. The sustained form is therefore as sensitive to this number; \
         the number is then a constant of the bearing and does not depend on the landing.",
    );
    output::show(&mut page, pictures);
    page.section("Peak contact force, N, by floor or reference speed");
    let header = header();
    page.table(&header.iter().map(String::as_str).collect::<Vec<_>>(), &rows(runs));
    page.note(&format!(
        "In this table: {}. runs.csv contains those of every run.",
        PerPeak::largest_bars(runs.iter().map(|r| &r.figures))
    ));
    limits::section(&mut page, base);
    page
}
