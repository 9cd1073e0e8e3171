//! The pictures of `host-sim accuracy`: errors over clearance and load, the worst runs over time,
//! networks beside the law.

use super::Outcome;
use crate::accuracy::conditions::Condition;
use crate::accuracy::estimate::{Tick, follow};
use crate::accuracy::{Accuracy, goals};
use crate::cli::error::CliError;
use crate::cli::output::{Files, Picture};
use crate::run::conditions::{BEARINGS, CLEARANCES_MM, LOADS_KN};
use crate::run::force::{self, ForceSource};
use crate::run::magnitude::after_start;
use crate::run::summary::{acceleration_reversals_s, oscillation_window_s};
use bench::BearingMaterial;
use report::figure::{Chart, Series, Style, lines, lines_log_log};
use report::heat::{self, Heat, Scale};

const WIDE: (u32, u32) = (1040, 340);
const HALF: (u32, u32) = (512, 340);
const TABLE: (u32, u32) = (512, 260);
/// Half of the stretch that is shown enlarged around the largest error, s.
const AROUND_S: f64 = 0.04;

/// The pictures by section.
pub(crate) struct Pictures {
    pub(crate) in_the_loop: Vec<Picture>,
    pub(crate) worst_loop: Vec<Picture>,
    pub(crate) estimate: Vec<Picture>,
    pub(crate) worst_estimate: Vec<Picture>,
    pub(crate) beside_law: Vec<Picture>,
}

impl Pictures {
    /// Adds all as files of their own.
    pub(crate) fn add_to(&self, files: &mut Files) -> Result<(), CliError> {
        [&self.in_the_loop, &self.worst_loop, &self.estimate, &self.worst_estimate, &self.beside_law]
            .into_iter()
            .try_for_each(|pictures| files.add_pictures(pictures))
    }
}

/// Draws everything.
pub(crate) fn draw(outcome: &Outcome) -> Result<Pictures, CliError> {
    let measured = |bearing: &BearingMaterial| outcome.runs.iter().any(|a| a.condition.bearing == *bearing);
    let (mut in_the_loop, mut estimate) = (Vec::new(), Vec::new());
    for bearing in BEARINGS.into_iter().filter(measured) {
        let name = bearing.name();
        let table =
            |file: &str, title: &str, goal: &goals::Goal, value: fn(&Accuracy) -> f64, caption: &str| {
                table(
                    outcome,
                    bearing,
                    (&format!("{file}-{name}"), &format!("{title}, {name}")),
                    goal,
                    value,
                    caption,
                )
            };
        let [peak, oscillation, force, _] = &goals::GOALS;
        in_the_loop.push(table("peak-change", "Peak force, change in %", peak, peak.value, "Goal: 2 %.")?);
        in_the_loop.push(table(
            "oscillation-change",
            "Oscillation, change in %",
            oscillation,
            oscillation.value,
            "Goal: 5 %.",
        )?);
        estimate.push(table(
            "estimate-error",
            "Estimator, error in % of full scale",
            force,
            force.value,
            "Goal: 3 % rms.",
        )?);
        let law = |a: &Accuracy| a.estimate.law.force_share;
        estimate.push(table(
            "law-error",
            "Law on the same signals, error in %",
            force,
            law,
            "What the signals alone allow.",
        )?);
    }
    let worst = |index: usize| {
        let verdict = outcome.goals.get(index);
        let standings = verdict.into_iter().flat_map(|v| [&v.paper, &v.held_out]);
        standings.max_by(|a, b| a.worst.abs().total_cmp(&b.worst.abs())).and_then(|s| s.at)
    };
    Ok(Pictures {
        in_the_loop,
        worst_loop: worst(1).map_or(Ok(Vec::new()), |c| over_time_in_the_loop(&c, outcome.step_us * 1e-6))?,
        estimate,
        worst_estimate: worst(2).map_or(Ok(Vec::new()), |c| over_time_estimated(&c, outcome.seed))?,
        beside_law: beside_law(&outcome.runs)?,
    })
}

/// Values in percent over the paper's clearances and loads.
fn table(
    outcome: &Outcome,
    bearing: BearingMaterial,
    (file, title): (&str, &str),
    goal: &goals::Goal,
    value: fn(&Accuracy) -> f64,
    caption: &str,
) -> Result<Picture, CliError> {
    let at = |clearance: f64, load: f64| {
        let here = |c: &Condition| {
            !c.held_out && c.bearing == bearing && c.clearance_mm == clearance && c.load_kn == load
        };
        outcome.runs.iter().find(|a| here(&a.condition)).map(|a| 100.0 * value(a))
    };
    let mut loads = LOADS_KN;
    loads.reverse();
    let heat = Heat {
        title,
        x: "load along +Y, kN",
        y: "clearance, mm",
        columns: loads.iter().map(|load| format!("{load:+}")).collect(),
        rows: CLEARANCES_MM.iter().map(f64::to_string).collect(),
        values: CLEARANCES_MM.iter().map(|c| loads.iter().map(|l| at(*c, *l)).collect()).collect(),
        scale: Scale::Limit(100.0 * goal.limit),
        decimals: 2,
        size: TABLE,
    };
    let drawing = heat::draw(&heat).map_err(CliError::Work)?;
    Ok(Picture { name: file.into(), caption: caption.into(), drawing })
}

/// The run in which the networks change the oscillation most, and that of the law, around the first
/// reversal.
fn over_time_in_the_loop(condition: &Condition, step_s: f64) -> Result<Vec<Picture>, CliError> {
    let law = condition.law_run()?;
    let network = force::run_bench(&law.bench, ForceSource::QuantisedNet, step_s, || {})?;
    let Some(reversal) = acceleration_reversals_s(&law.bench).first().copied() else { return Ok(Vec::new()) };
    let (from, to) = oscillation_window_s(&law.bench, reversal);
    let curve = |name: &str, run: &force::ForcedRun| {
        let samples = after_start(&law.bench, &run.run.samples);
        let inside = samples.iter().filter(|s| (from..=to).contains(&s.time_s));
        Series::through(name, inside.map(|s| (s.time_s, s.forces.normal_n)).collect())
    };
    let title = format!("Contact force, {}", condition.name());
    let curves =
        [curve("analytic law", &law.forced).styled(Style::Wide), curve("quantised networks", &network)];
    let chart = Chart { title: &title, x: "time, s", y: "N", size: WIDE };
    let caption = "The run in which the networks change the oscillation most, in the interval where it is \
        measured: the law below, the networks above.";
    Ok(vec![Picture::draw(lines, "worst-oscillation", &chart, &curves, caption)?])
}

/// The run with the estimator's largest error: all of it, and enlarged where the estimate is
/// furthest off.
fn over_time_estimated(condition: &Condition, seed: u64) -> Result<Vec<Picture>, CliError> {
    let law = condition.law_run()?;
    let ticks = follow(condition, &law, Some(seed))?;
    let off = |tick: &Tick| (tick.network[0] - tick.truth.forces.normal_n).abs();
    let furthest = ticks.iter().max_by(|a, b| off(a).total_cmp(&off(b))).map_or(0.0, |t| t.truth.time_s);
    let curve = |name: &str, read: fn(&Tick) -> f64, (from, to): (f64, f64)| {
        let inside = ticks.iter().filter(|t| (from..=to).contains(&t.truth.time_s));
        Series::through(name, inside.map(|t| (t.truth.time_s, read(t))).collect())
    };
    let truth: fn(&Tick) -> f64 = |t| t.truth.forces.normal_n;
    let end_s = law.bench.duration_s();
    let span_s = (law.bench.load.ramp_s, end_s);
    let near = ((furthest - AROUND_S).max(span_s.0), (furthest + AROUND_S).min(end_s));
    let title = format!("Contact force and estimate, {}", condition.name());
    let chart = Chart { title: &title, x: "time, s", y: "N", size: WIDE };
    let over = [curve("estimator", |t| t.network[0], span_s), curve("bench", truth, span_s)];
    let enlarged = [
        curve("bench", truth, near).styled(Style::Wide),
        curve("estimator", |t| t.network[0], near),
        curve("law on its signals", |t| t.law[0], near),
    ];
    let detail = Chart { title: "The same where the estimate is furthest off", ..chart };
    let torque = [
        curve("estimator", |t| t.network[1], span_s),
        curve("bench", |t| t.truth.friction_torque_nm, span_s),
    ];
    let torques = Chart { title: "Friction torque and estimate of that run", y: "N m", ..chart };
    Ok(vec![
        Picture::draw(lines, "worst-estimate", &chart, &over, "The run with the estimator's largest error.")?,
        Picture::draw(
            lines,
            "worst-estimate-detail",
            &detail,
            &enlarged,
            "What the law makes of the same conditioned signals shows how much is the signals' doing.",
        )?,
        Picture::draw(
            lines,
            "worst-estimate-torque",
            &torques,
            &torque,
            "Negative while the shaft turns forward.",
        )?,
    ])
}

/// Error of the estimator over the error of the law on the same signals, a point a run.
fn beside_law(runs: &[Accuracy]) -> Result<Vec<Picture>, CliError> {
    let points = |bearing: BearingMaterial, read: fn(&Accuracy) -> (f64, f64)| {
        let of = runs.iter().filter(|a| a.condition.bearing == bearing).map(read);
        Series::through(bearing.name(), of.map(|(x, y)| (100.0 * x, 100.0 * y)).collect())
            .styled(Style::Points)
    };
    let picture = |file: &str, title: &str, read: fn(&Accuracy) -> (f64, f64), caption: &str| {
        let mut series = BEARINGS.map(|bearing| points(bearing, read)).to_vec();
        let ends = series.iter().flat_map(|s| &s.points).flat_map(|p| [p.0, p.1]).filter(|v| *v > 0.0);
        let (low, high) = ends.fold((f64::INFINITY, 0.0_f64), |(a, b), v| (a.min(v), b.max(v)));
        if low < high {
            series.push(Series::through("equal", vec![(low, low), (high, high)]));
        }
        let chart = Chart { title, x: "law on the same signals, %", y: "estimator, %", size: HALF };
        Picture::draw(lines_log_log, file, &chart, &series, caption)
    };
    Ok(vec![
        picture(
            "beside-law-force",
            "Force, rms error of full scale",
            |a| (a.estimate.law.force_share, a.estimate.network.force_share),
            "A point a run; above the line the law errs less than the networks.",
        )?,
        picture(
            "beside-law-torque",
            "Friction torque, rms error of full scale",
            |a| (a.estimate.law.torque_share, a.estimate.network.torque_share),
            "The same for the friction torque.",
        )?,
    ])
}
