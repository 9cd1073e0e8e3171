//! The page and the table of `host-sim accuracy`.

use super::Outcome;
use super::pictures::Pictures;
use crate::accuracy::Accuracy;
use crate::accuracy::conditions::{ANGLE_NOISE_DEG, POSITION_NOISE_M};
use crate::accuracy::estimate::Errors;
use crate::accuracy::goals::{Standing, Verdict};
use crate::accuracy::in_the_loop::Change;
use crate::cli::{limits, output};
use crate::run::conditions::BEARINGS;
use bench::description::TransmissionBench;
use model_quant::evaluate::bench_loop::Spread;
use report::page::Page;
use report::text_table;

fn percent(share: f64) -> String {
    format!("{:+.2}", 100.0 * share)
}

fn value(verdict: &Verdict, value: f64) -> String {
    if verdict.unit == "share" {
        format!("{:.2} %", 100.0 * value)
    } else {
        format!("{value:.3} {}", verdict.unit)
    }
}

fn standing(verdict: &Verdict, standing: &Standing) -> String {
    let Some(at) = standing.at else { return "no runs".into() };
    if standing.worst == 0.0 {
        return format!("in all {} runs 0 {}", standing.runs, verdict.unit);
    }
    format!(
        "worst {} ({}), median {}, {} of {} runs within",
        value(verdict, standing.worst),
        at.name(),
        value(verdict, standing.median),
        standing.within,
        standing.runs
    )
}

fn goal_rows(outcome: &Outcome) -> Vec<Vec<String>> {
    let met = |met: bool| if met { "met" } else { "not met" };
    let row = |v: &Verdict| {
        vec![v.goal.to_owned(), standing(v, &v.paper), standing(v, &v.held_out), met(v.met).to_owned()]
    };
    outcome.goals.iter().map(row).collect()
}

const GOAL_HEADER: [&str; 4] = ["goal", "the paper's clearances and loads", "held-out conditions", "verdict"];

fn lead(outcome: &Outcome) -> String {
    let met = outcome.goals.iter().filter(|v| v.met).count();
    let ratios = || outcome.runs.iter().map(|a| a.estimate.network.force_rms_n / a.estimate.law.force_rms_n);
    format!(
        "{met} of {} goals met over {} runs of bench B. At the estimated contact the described law, without \
         what the filter has learnt, has a smaller error than the estimate in {} of {} runs; the \
         estimate's error is {:.2} to {:.2} times the law's.",
        outcome.goals.len(),
        outcome.runs.len(),
        outcome.law_wins,
        outcome.runs.len(),
        ratios().fold(f64::INFINITY, f64::min),
        ratios().fold(0.0, f64::max)
    )
}

/// A row a bearing and set: `name` and the spread of every value.
fn spreads<const N: usize>(
    outcome: &Outcome,
    name: &str,
    values: [fn(&Accuracy) -> f64; N],
    format: [fn(f64) -> String; N],
) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    for bearing in BEARINGS {
        for held_out in [false, true] {
            let of = |a: &&Accuracy| a.condition.bearing == bearing && a.condition.held_out == held_out;
            if outcome.runs.iter().filter(of).count() == 0 {
                continue;
            }
            let set = if held_out { "held out" } else { "paper's" };
            let mut row = vec![bearing.name().to_owned(), set.to_owned(), name.to_owned()];
            for (value, format) in values.iter().zip(format) {
                let Spread { median, largest } =
                    Spread::from_values(outcome.runs.iter().filter(of).map(value));
                row.extend([format(median), format(largest)]);
            }
            rows.push(row);
        }
    }
    rows
}

fn loop_rows(outcome: &Outcome) -> Vec<Vec<String>> {
    let plain: fn(f64) -> String = |share| format!("{:.2}", 100.0 * share);
    macro_rules! rows {
        ($name:expr, $field:ident) => {
            spreads(
                outcome,
                &$name,
                [|a| a.in_the_loop.$field.peak, |a| a.in_the_loop.$field.oscillation],
                [plain; 2],
            )
        };
    }
    let (step, double) = (outcome.step_us, 2.0 * outcome.step_us);
    [
        rows!(format!("networks, {step} us"), network),
        rows!(format!("law held for {step} us"), held_law),
        rows!(format!("networks, {double} us"), network_double_step),
        rows!(format!("law held for {double} us"), held_law_double_step),
    ]
    .concat()
}

fn estimate_rows(outcome: &Outcome) -> Vec<Vec<String>> {
    macro_rules! rows {
        ($name:expr, $field:ident) => {
            spreads(
                outcome,
                $name,
                [
                    |a| a.estimate.$field.force_rms_n,
                    |a| a.estimate.$field.force_share,
                    |a| a.estimate.$field.torque_rms_nm,
                ],
                [|n| format!("{n:.0}"), |share| format!("{:.2}", 100.0 * share), |nm| format!("{nm:.2}")],
            )
        };
    }
    [
        rows!("estimator", network),
        rows!("float networks, same contact", float_network),
        rows!("described law, same contact", law),
        rows!("estimator, perfect sensors", perfect_sensors),
        rows!("law, perfect sensors", law_perfect_sensors),
    ]
    .concat()
}

const RUN_HEADER: [&str; 14] = [
    "run",
    "set",
    "peak, N",
    "change, %",
    "held law, %",
    "oscillation, N rms",
    "change, %",
    "held law, %",
    "estimator, N rms",
    "of full scale, %",
    "described law, same contact, %",
    "torque, N m rms",
    "of full scale, %",
    "without contact, N",
];

fn run_cells(a: &Accuracy) -> Vec<String> {
    let (Change { peak, oscillation }, held) = (a.in_the_loop.network, a.in_the_loop.held_law);
    let Errors { force_rms_n, force_share, torque_rms_nm, torque_share } = a.estimate.network;
    vec![
        a.condition.name(),
        if a.condition.held_out { "held out" } else { "paper's" }.into(),
        format!("{:.0}", a.in_the_loop.peak_contact_force_n),
        percent(peak),
        percent(held.peak),
        format!("{:.0}", a.in_the_loop.oscillation_rms_n),
        percent(oscillation),
        percent(held.oscillation),
        format!("{force_rms_n:.0}"),
        format!("{:.2}", 100.0 * force_share),
        format!("{:.2}", 100.0 * a.estimate.law.force_share),
        format!("{torque_rms_nm:.2}"),
        format!("{:.2}", 100.0 * torque_share),
        format!("{:.3}", a.gap.largest_n().max(a.in_the_loop.without_contact_n)),
    ]
}

/// Goals and a row for each run on the terminal.
pub(crate) fn print(outcome: &Outcome) {
    print_line!("{}", text_table(RUN_HEADER, outcome.runs.iter().map(run_cells), 2));
    for row in goal_rows(outcome) {
        if let [goal, paper, held_out, verdict] = row.as_slice() {
            print_line!("\n{verdict}: {goal}\n  paper's:  {paper}\n  held out: {held_out}");
        }
    }
    print_line!("\n{}", lead(outcome));
}

/// The page.
pub(crate) fn page(outcome: &Outcome, pictures: &Pictures, bench: &TransmissionBench) -> Page {
    let mut page = Page::new("Accuracy of networks and estimator");
    page.lead(&lead(outcome));
    page.table(&GOAL_HEADER, &goal_rows(outcome));
    page.note(
        "The worst run decides every verdict. The held-out conditions have clearances, loads and drive \
         periods that are not in the paper's list. The reference is the error-controlled run with the \
         analytic law.",
    );
    page.section("Networks in place of the law");
    page.text(&format!(
        "The run with the quantised networks, compared with the error-controlled run with the law. The \
         networks' force is held for {} us. The law held over the same step shows the share of the step \
         in the change.",
        outcome.step_us
    ));
    output::show(&mut page, &pictures.in_the_loop);
    page.note("White: no change; blue: within the goal; orange: outside the goal.");
    let header =
        ["bearing", "set", "run with", "peak, median %", "largest %", "oscillation, median %", "largest %"];
    page.table(&header, &loop_rows(outcome));
    pictures.worst_loop.iter().for_each(|p| {
        page.figure(&p.drawing, &p.caption);
    });
    page.section("The estimator with noisy sensors");
    page.text(&format!(
        "White noise at 10 kHz: position sensors {:.1} um, angle sensor {ANGLE_NOISE_DEG} deg. The analytic \
         law and the float networks use the same conditioned contact as the estimator, so the law's error \
         is the error of the signals.",
        POSITION_NOISE_M * 1e6
    ));
    output::show(&mut page, &pictures.estimate);
    let header = [
        "bearing",
        "set",
        "force from",
        "force, median N rms",
        "largest N",
        "median % of full scale",
        "largest %",
        "torque, median N m rms",
        "largest N m",
    ];
    page.table(&header, &estimate_rows(outcome));
    pictures.worst_estimate.iter().for_each(|p| {
        page.figure(&p.drawing, &p.caption);
    });
    output::show(&mut page, &pictures.beside_law);
    page.section("Every run").table(&RUN_HEADER, &outcome.runs.iter().map(run_cells).collect::<Vec<_>>());
    page.note("accuracy.json contains all figures.");
    limits::section(&mut page, bench);
    page
}
