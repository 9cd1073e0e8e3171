//! `host-sim sweep step`: how far the communication step alone moves a run away from the analytic law.
//!
//! A network's force is held over the communication step, so a run with networks has two errors: the step's and the networks' own. The law held
//! over the same steps has the first one only. Where a source's distance no longer falls with the step, what is left is the source's.

use super::limits;
use super::output::{self, Picture};
use super::sweep::RunOptions;
use crate::error::CliError;
use crate::figure::{Chart, Series, Style, lines_log_log};
use crate::force::{self, ForceSource, ForcedRun, SAMPLE_RATE_HZ};
use crate::page::Page;
use crate::paper::{BEARINGS, resolved, variant};
use crate::summary::{AgainstLaw, Figures};
use crate::sweep::table;
use crate::{parallel, progress};
use bench::BearingMaterial;
use bench::description::TransmissionBench;
use serde::Serialize;
use std::path::Path;

/// Communication steps, us.
const STEPS_US: [f64; 8] = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0];
/// Sources whose force is held.
const SOURCES: [ForceSource; 3] = [ForceSource::HeldLaw, ForceSource::FloatNet, ForceSource::QuantisedNet];
/// A step is small enough for networks when the distance from the law is within this factor of that at the smallest step: when the step
/// costs no more than the networks.
const ENOUGH: f64 = 2.0;

/// One run.
#[derive(Clone, Debug, Serialize)]
struct StepRun {
    bearing: BearingMaterial,
    force: ForceSource,
    step_us: f64,
    /// Rms difference of the normal force from the error-controlled law; none where the run came to nothing.
    force_rms_difference_n: Option<f64>,
    /// The same over the law's peak force.
    force_rms_share: Option<f64>,
    /// Rms difference of the journal's position.
    journal_rms_difference_m: Option<f64>,
    /// Peak force over that of the law, less one.
    peak_change: Option<f64>,
    /// Oscillation over that of the law, less one.
    oscillation_change: Option<f64>,
    wall_s_per_simulated_s: Option<f64>,
    /// Why the run came to nothing.
    stopped: Option<String>,
}

/// What follows for a bearing and a source.
#[derive(Clone, Debug, Serialize)]
struct Choice {
    bearing: BearingMaterial,
    force: ForceSource,
    /// The largest step at which the step costs no more than the networks: the distance from the law is at most twice that at the smallest one.
    /// None for the law, which has no error of its own.
    small_enough_us: Option<f64>,
    /// The largest step that the run survives.
    largest_us: Option<f64>,
}

#[derive(Serialize)]
struct Outcome {
    runs: Vec<StepRun>,
    choices: Vec<Choice>,
}

/// Runs the steps and writes runs.csv, sweep.json, pictures and report.html.
pub(super) fn run(options: &RunOptions, folder: &Path, json: bool) -> Result<(), CliError> {
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
            "[two_plane]: found; expected a planar bench: nothing is held on the other".into(),
        ));
    }
    output::ready(folder)?;
    let benches = BEARINGS.map(|bearing| {
        resolved(variant(&base, bearing, base.bearing.radial_clearance_m * 1e3, base.load.force_n * 1e-3))
    });
    let benches: Vec<TransmissionBench> = benches.into_iter().collect::<Result<_, _>>()?;
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
    let bar = progress::bar(json, cases.len() as u64);
    bar.set_message("communication steps");
    let runs = parallel::map(options.threads, &cases, |_, &(bench, law, source, step_us)| {
        let run = one(bench, law, source, step_us);
        bar.inc(1);
        run
    })?;
    bar.finish_and_clear();
    let choices = runs.chunks(STEPS_US.len()).filter_map(choice).collect();
    let outcome = Outcome { runs, choices };
    let text = output::json(&outcome)?;
    let pictures = pictures(&outcome.runs)?;
    output::write(folder, "runs.csv", &table::csv(&outcome.runs)?)?;
    output::write(folder, "sweep.json", &format!("{text}\n"))?;
    output::save(folder, &pictures)?;
    output::write(folder, "report.html", &page(&outcome, &pictures, limits::plant_of(&base)).render())?;
    if json {
        say!("{text}");
    } else {
        let line = |cells: &[String]| cells.iter().map(|c| format!("{c:>13}")).collect::<Vec<_>>().join(" ");
        say!("rms difference of the contact force from the error-controlled law, N, by communication step");
        say!("{}", line(&header()));
        rows(&outcome).iter().for_each(|row| say!("{}", line(row)));
        say!("\nreport: {}", folder.join("report.html").display());
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
        // Too coarse a step throws the journal out of the model: that is an outcome.
        Err(CliError::Work(reason)) => return Ok(StepRun { stopped: Some(reason), ..nothing }),
        Err(error) => return Err(error),
    };
    let against = AgainstLaw::of(bench, &forced.run.samples, &law.run.samples);
    let figures = |source, forced| Figures::of(bench, source, forced, SAMPLE_RATE_HZ);
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

/// Of the runs of one bearing and source, in the order of their steps.
fn choice(runs: &[StepRun]) -> Option<Choice> {
    let first = runs.first()?;
    let sound = || runs.iter().take_while(|r| r.force_rms_difference_n.is_some());
    // A first run that was stopped leaves nothing to compare with: no step is small enough.
    let least = first.force_rms_difference_n.unwrap_or_default();
    let enough = sound().take_while(|r| r.force_rms_difference_n.is_some_and(|d| d <= ENOUGH * least));
    Some(Choice {
        bearing: first.bearing,
        force: first.force,
        small_enough_us: enough.last().map(|r| r.step_us).filter(|_| first.force != ForceSource::HeldLaw),
        largest_us: sound().last().map(|r| r.step_us),
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
        let caption = "Contact force of a run with a held force less that of the error-controlled law.";
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

fn page(outcome: &Outcome, pictures: &[Picture], plant: &str) -> Page {
    let mut page = Page::new("The communication step");
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
            " With the quantised networks a step of {} is small enough: there the step costs no more than the networks.",
            of_networks.join(" and ")
        )
    };
    page.lead(&format!(
        "A force from outside is held over a communication step, and the step alone moves the run away from the law.{networks}"
    ));
    page.note(
        "The law held over the step has the step's error only; networks have it and their own. Small enough is the largest step whose distance is \
         at most twice that at 1 us. A step that the run does not survive is marked stopped: in sustained contact the damping makes the loop stiff.",
    );
    output::show(&mut page, pictures);
    page.section("Rms difference of the contact force from the law, N");
    let header = header();
    page.table(&header.iter().map(String::as_str).collect::<Vec<_>>(), &rows(outcome));
    page.note("runs.csv has peaks, oscillation, the journal's distance and the wall time of each run.");
    limits::section(&mut page, plant);
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
