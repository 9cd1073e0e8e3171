//! `host-sim sweep step`: effect of the communication step on the difference from the analytic law.
//!
//! A network's force is held over the communication step, so a run with networks has two errors:
//! that of the step and that of the networks. The law held over the same steps has only the first.
//! If the difference no longer falls with the step, the remainder is the error of the source.

use super::options::SweepOptions;
use super::owner;
use super::table;
use crate::cli::error::CliError;
use crate::cli::limits;
use crate::cli::output::{self, Files, Picture};
use crate::cli::{parallel, progress};
use crate::run::conditions::{BEARINGS, variant};
use crate::run::force::{self, ForceSource, ForcedRun, SAMPLE_RATE_HZ};
use crate::run::summary::{AgainstLaw, Figures};
use bench::BearingMaterial;
use bench::description::TransmissionBench;
use report::figure::{Chart, Series, Style, lines_log_log};
use report::page::Page;
use report::text_table;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::Path;

/// Communication steps, us.
const STEPS_US: [f64; 8] = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0];
/// Sources whose force is held.
const SOURCES: [ForceSource; 3] = [ForceSource::HeldLaw, ForceSource::FloatNet, ForceSource::QuantisedNet];
/// A step is small enough for networks if the difference from the law is at most this factor times
/// that at the smallest step. Then the step's error is at most as large as the networks'.
const ENOUGH: f64 = 2.0;

/// One run.
#[derive(Clone, Debug, Serialize, JsonSchema)]
struct StepRun {
    #[schemars(with = "String")]
    bearing: BearingMaterial,
    force: ForceSource,
    step_us: f64,
    /// Rms difference of the normal force from the error-controlled law; none where the run failed.
    force_rms_difference_n: Option<f64>,
    /// The same relative to the law's peak force.
    force_rms_share: Option<f64>,
    /// Rms difference of the journal's position.
    journal_rms_difference_m: Option<f64>,
    /// Relative change of the peak force from the law.
    peak_change: Option<f64>,
    /// Relative change of the oscillation from the law.
    oscillation_change: Option<f64>,
    wall_s_per_simulated_s: Option<f64>,
    /// Reason why the run failed.
    stopped: Option<String>,
}

/// Result for a bearing and a source.
#[derive(Clone, Debug, Serialize, JsonSchema)]
struct Choice {
    #[schemars(with = "String")]
    bearing: BearingMaterial,
    force: ForceSource,
    /// Largest step that is small enough: its difference from the law is at most twice that at the
    /// smallest step. None for the law, whose only error is that of the step.
    small_enough_us: Option<f64>,
    /// Largest step at which the run does not fail.
    largest_us: Option<f64>,
}

#[derive(Serialize, JsonSchema)]
pub(crate) struct Outcome {
    sweep: &'static str,
    runs: Vec<StepRun>,
    choices: Vec<Choice>,
}

/// Name of the sweep in its results.
const NAME: &str = "step";

/// Runs the steps and writes runs.csv, sweep.json, pictures and report.html.
pub(crate) fn run(options: &SweepOptions, folder: &Path, json: bool) -> Result<(), CliError> {
    let sources: Vec<ForceSource> = match options.force {
        None => SOURCES.to_vec(),
        Some(ForceSource::Law) => {
            return Err(CliError::Input(
                "--force: found law; expected a source that is held over a step".into(),
            ));
        }
        Some(source) => vec![source],
    };
    let base = options.base()?;
    if base.two_plane.is_some() {
        return Err(CliError::Input(
            "[two_plane]: found; expected a planar bench: a held force requires one".into(),
        ));
    }
    output::check_folder(folder)?;
    owner::check(folder, NAME)?;
    let benches = BEARINGS.map(|bearing| {
        variant(&base, bearing, base.bearing.radial_clearance_m * 1e3, base.load.force_n * 1e-3).resolved()
    });
    let laws = parallel::map(options.threads, &benches, |_, bench| {
        force::run_bench(bench, ForceSource::Law, options.step_s()?, || {})
    })?;
    let held: Vec<(&TransmissionBench, &ForcedRun)> = benches.iter().zip(&laws).collect();
    let mut cases = Vec::new();
    for (bench, law) in held {
        for &source in &sources {
            cases.extend(STEPS_US.map(|step_us| (bench, law, source, step_us)));
        }
    }
    let bar = progress::bar(cases.len() as u64);
    bar.set_message("communication steps");
    let runs = parallel::map(options.threads, &cases, |_, &(bench, law, source, step_us)| {
        let run = one(bench, law, source, step_us);
        bar.inc(1);
        run
    })?;
    bar.finish_and_clear();
    let choices = runs.chunks(STEPS_US.len()).filter_map(choice).collect();
    let outcome = Outcome { sweep: NAME, runs, choices };
    let pictures = pictures(&outcome.runs)?;
    let mut files = Files::new(folder);
    files.add("runs.csv", &table::csv(&outcome.runs)?)?;
    let text = files.add_result("sweep.json", &outcome)?;
    files.add_pictures(&pictures)?;
    files.add_page("report.html", page(&outcome, &pictures, &base))?;
    files.publish()?;
    if json {
        print_result!("{text}");
    } else {
        print_line!(
            "rms difference of the contact force from the error-controlled law, N, by communication step"
        );
        print_line!("{}", text_table(header(), rows(&outcome), 2));
        print_line!("\nreport: {}", folder.join("report.html").display());
    }
    Ok(())
}

fn one(
    bench: &TransmissionBench,
    law: &ForcedRun,
    source: ForceSource,
    step_us: f64,
) -> Result<StepRun, CliError> {
    let nothing = StepRun {
        bearing: bench.bearing.material,
        force: source,
        step_us,
        force_rms_difference_n: None,
        force_rms_share: None,
        journal_rms_difference_m: None,
        peak_change: None,
        oscillation_change: None,
        wall_s_per_simulated_s: None,
        stopped: None,
    };
    let forced = match force::run_bench(bench, source, step_us * 1e-6, || {}) {
        Ok(forced) => forced,
        // Too coarse a step moves the journal out of the model's range. This is a result, not an
        // error.
        Err(CliError::Work(reason)) => return Ok(StepRun { stopped: Some(reason), ..nothing }),
        Err(error) => return Err(error),
    };
    let against = AgainstLaw::compare(bench, &forced.run.samples, &law.run.samples);
    let figures = |source, forced| Figures::from_run(bench, source, forced, SAMPLE_RATE_HZ);
    let (own, laws) = (figures(source, &forced), figures(ForceSource::Law, law));
    Ok(StepRun {
        force_rms_difference_n: Some(against.force_rms_difference_n),
        force_rms_share: Some(against.force_rms_difference_n / laws.peak_contact_force_n),
        journal_rms_difference_m: Some(against.journal_rms_difference_m),
        peak_change: Some(own.peak_contact_force_n / laws.peak_contact_force_n - 1.0),
        oscillation_change: Some(own.oscillation_rms_n / laws.oscillation_rms_n - 1.0),
        wall_s_per_simulated_s: Some(forced.wall_s / bench.duration_s()),
        ..nothing
    })
}

/// Evaluates the runs of one bearing and source, in the order of their steps.
fn choice(runs: &[StepRun]) -> Option<Choice> {
    let first = runs.first()?;
    let completed = || runs.iter().take_while(|r| r.force_rms_difference_n.is_some());
    // If the first run failed, there is nothing to compare with, and no step is small enough.
    let smallest_step_n = first.force_rms_difference_n.unwrap_or_default();
    let enough =
        completed().take_while(|r| r.force_rms_difference_n.is_some_and(|d| d <= ENOUGH * smallest_step_n));
    Some(Choice {
        bearing: first.bearing,
        force: first.force,
        small_enough_us: enough.last().map(|r| r.step_us).filter(|_| first.force != ForceSource::HeldLaw),
        largest_us: completed().last().map(|r| r.step_us),
    })
}

fn header() -> Vec<String> {
    let steps = STEPS_US.iter().map(|s| format!("{s} us"));
    ["bearing", "force from"]
        .into_iter()
        .map(String::from)
        .chain(steps)
        .chain(["small enough".into()])
        .collect()
}

fn rows(outcome: &Outcome) -> Vec<Vec<String>> {
    let row = |(group, choice): (&[StepRun], &Choice)| {
        let start = [choice.bearing.name().to_owned(), choice.force.name().to_owned()];
        let cells = group.iter().map(|r| match r.force_rms_difference_n {
            Some(difference) if difference < 1e6 => format!("{difference:.1}"),
            Some(difference) => format!("{difference:.1e}"),
            None => "stopped".into(),
        });
        let enough = choice.small_enough_us.map_or_else(|| "-".into(), |s| format!("{s} us"));
        start.into_iter().chain(cells).chain([enough]).collect()
    };
    outcome.runs.chunks(STEPS_US.len()).zip(&outcome.choices).map(row).collect()
}

fn pictures(runs: &[StepRun]) -> Result<Vec<Picture>, CliError> {
    let mut pictures = Vec::new();
    for bearing in BEARINGS {
        let of = |source: ForceSource| {
            let own = runs.iter().filter(|r| r.bearing == bearing && r.force == source);
            let points = own.filter_map(|r| Some((r.step_us, r.force_rms_difference_n?))).collect();
            Series::through(source.name(), points).styled(Style::Both)
        };
        let series: Vec<Series> =
            SOURCES.into_iter().filter(|s| runs.iter().any(|r| r.force == *s)).map(of).collect();
        let title = format!("Distance from the law, {}", bearing.name());
        let chart =
            Chart { title: &title, x: "communication step, us", y: "rms of the force, N", size: (512, 360) };
        let caption = "Contact force of a run with a held force minus that of the error-controlled law.";
        pictures.push(Picture::draw(
            lines_log_log,
            &format!("step-{}", bearing.name()),
            &chart,
            &series,
            caption,
        )?);
    }
    Ok(pictures)
}

fn page(outcome: &Outcome, pictures: &[Picture], base: &TransmissionBench) -> Page {
    let mut page = Page::new("Communication step");
    let of_networks: Vec<String> = outcome
        .choices
        .iter()
        .filter(|c| c.force == ForceSource::QuantisedNet)
        .map(|c| {
            let step = c.small_enough_us.map_or_else(|| "no step".into(), |s| format!("{s} us"));
            format!("{step} ({})", c.bearing.name())
        })
        .collect();
    let networks = if of_networks.is_empty() {
        String::new()
    } else {
        format!(
            " With the quantised networks a step of {} is small enough: its error is at most as large as \
             the networks' error.",
            of_networks.join(" and ")
        )
    };
    page.lead(&format!(
        "A network's force is held over a communication step, and this alone changes the run.{networks}"
    ));
    page.note(
        "The held law has the error of the step only; networks add their own. A step is small enough if the \
         difference from the law is at most twice that at 1 us. A failed run is marked stopped: in \
         sustained contact the damping makes the loop stiff.",
    );
    output::show(&mut page, pictures);
    page.section("Rms difference of the contact force from the law, N");
    let header = header();
    page.table(&header.iter().map(String::as_str).collect::<Vec<_>>(), &rows(outcome));
    page.note(
        "runs.csv contains peaks, oscillation, difference of the journal's position and wall time of \
        each run.",
    );
    limits::section(&mut page, base);
    page
}

#[cfg(test)]
mod tests {
    use super::*;

    fn runs(differences: &[Option<f64>]) -> Vec<StepRun> {
        let run = |(&step_us, &difference): (&f64, &Option<f64>)| StepRun {
            bearing: BearingMaterial::Babbitt,
            force: ForceSource::QuantisedNet,
            step_us,
            force_rms_difference_n: difference,
            force_rms_share: None,
            journal_rms_difference_m: None,
            peak_change: None,
            oscillation_change: None,
            wall_s_per_simulated_s: None,
            stopped: None,
        };
        STEPS_US.iter().zip(differences).map(run).collect()
    }

    #[test]
    fn a_step_is_small_enough_before_the_distance_grows_and_a_stopped_run_ends_the_list() {
        let some = |values: &[f64]| values.iter().map(|v| Some(*v)).collect::<Vec<_>>();
        let mut differences = some(&[4.0, 4.5, 7.9, 8.1, 4.0, 300.0]);
        differences.push(None);
        let found = choice(&runs(&differences)).unwrap();
        assert_eq!((found.small_enough_us, found.largest_us), (Some(5.0), Some(50.0)));
        let stopped = choice(&runs(&[None, Some(1.0)])).unwrap();
        assert_eq!((stopped.small_enough_us, stopped.largest_us), (None, None));
        assert!(choice(&[]).is_none());
    }
}
