//! The tables and the page of `host-sim accuracy --worlds`.

use super::cases::{OperatingPoint, Set};
use super::estimators::EstimatorKind::{self, Law, LawWithDriveForce, Network};
use super::goals::{Limit, Verdict};
use super::outcome::Outcome;
use super::pictures::Pictures;
use super::score::{Case, START_S};
use crate::cli::{limits, output};
use ::worlds::{Deviations, Sensors};
use bench::description::TransmissionBench;
use bench::statistics::mean;
use model_quant::evaluate::bench_loop::Spread;
use report::page::Page;
use report::text_table;

type Rows = Vec<Vec<String>>;

const FORCE_HEADER: [&str; 10] = [
    "force, % of full scale",
    "exact",
    "drawn, median",
    "drawn, worst",
    "largest error",
    "in 2 sd",
    "with drive force, worst",
    "law, exact",
    "law, median",
    "law, worst",
];
const TORQUE_HEADER: [&str; 9] = [
    "torque, % of full scale",
    "exact",
    "drawn, median",
    "drawn, worst",
    "at reversals, worst",
    "in 2 sd",
    "law, exact",
    "law, median",
    "law, worst",
];
const WORLD_HEADER: [&str; 7] = [
    "force, % of full scale",
    "median",
    "worst",
    "largest error",
    "in 2 sd, fewest",
    "with drive force, worst",
    "law, worst",
];

fn percent(share: f64) -> String {
    format!("{:.2}", 100.0 * share)
}

fn percent_or_none(share: Option<f64>) -> String {
    share.map_or_else(|| "-".into(), |share| format!("{:.1}", 100.0 * share))
}

/// Cases of a set of worlds.
struct Selection<'a>(Vec<&'a Case>);

impl<'a> Selection<'a> {
    fn new(cases: &'a [Case], is_chosen: impl Fn(&Case) -> bool) -> Self {
        Self(cases.iter().filter(|case| is_chosen(case)).collect())
    }

    fn spread(&self, estimator: EstimatorKind, value: fn(&Case) -> f64) -> Spread {
        Spread::from_values(self.of_estimator(estimator).map(value))
    }

    fn of_estimator(&self, estimator: EstimatorKind) -> impl Iterator<Item = &'a Case> {
        self.0.iter().copied().filter(move |case| case.estimator == estimator)
    }

    fn median(&self, estimator: EstimatorKind, value: fn(&Case) -> f64) -> String {
        percent(self.spread(estimator, value).median)
    }

    fn worst(&self, estimator: EstimatorKind, value: fn(&Case) -> f64) -> String {
        percent(self.spread(estimator, value).largest)
    }

    /// Mean coverage with the networks.
    fn inside(&self, value: fn(&Case) -> Option<f64>) -> Option<f64> {
        let inside: Vec<f64> = self.of_estimator(Network).filter_map(value).collect();
        (!inside.is_empty()).then(|| mean(inside))
    }
}

/// Operating points with cases.
fn points(outcome: &Outcome) -> impl Iterator<Item = OperatingPoint> {
    OperatingPoint::all().into_iter().filter(|point| outcome.cases.iter().any(|case| case.point == *point))
}

/// Exact and drawn worlds of an operating point.
fn exact_and_drawn(outcome: &Outcome, point: OperatingPoint) -> [Selection<'_>; 2] {
    [Set::Exact, Set::Drawn]
        .map(|set| Selection::new(&outcome.cases, |case| case.point == point && case.set == set))
}

fn force_rows(outcome: &Outcome) -> Rows {
    let row = |point: OperatingPoint| {
        let [exact, drawn] = exact_and_drawn(outcome, point);
        vec![
            point.name(),
            exact.worst(Network, Case::force_share),
            drawn.median(Network, Case::force_share),
            drawn.worst(Network, Case::force_share),
            drawn.worst(Network, Case::max_share),
            percent_or_none(drawn.inside(|case| case.inside_2sd)),
            drawn.worst(LawWithDriveForce, Case::force_share),
            exact.worst(Law, Case::force_share),
            drawn.median(Law, Case::force_share),
            drawn.worst(Law, Case::force_share),
        ]
    };
    points(outcome).map(row).collect()
}

fn torque_rows(outcome: &Outcome) -> Rows {
    let row = |point: OperatingPoint| {
        let [exact, drawn] = exact_and_drawn(outcome, point);
        vec![
            point.name(),
            exact.worst(Network, Case::torque_share),
            drawn.median(Network, Case::torque_share),
            drawn.worst(Network, Case::torque_share),
            drawn.worst(Network, |case| case.torque_reversal_share().unwrap_or_default()),
            percent_or_none(drawn.inside(|case| case.torque_inside_2sd)),
            exact.worst(Law, Case::torque_share),
            drawn.median(Law, Case::torque_share),
            drawn.worst(Law, Case::torque_share),
        ]
    };
    points(outcome).map(row).collect()
}

/// A row for each world of a set, over all operating points.
fn world_rows(outcome: &Outcome, set: Set) -> Rows {
    let mut names: Vec<&str> = Vec::new();
    for case in outcome.cases.iter().filter(|case| case.set == set) {
        if !names.contains(&case.world.as_str()) {
            names.push(&case.world);
        }
    }
    let row = |name: &&str| {
        let of_world = Selection::new(&outcome.cases, |case| case.set == set && case.world == *name);
        let inside = of_world.of_estimator(Network).filter_map(|case| case.inside_2sd).reduce(f64::min);
        vec![
            (*name).to_owned(),
            of_world.median(Network, Case::force_share),
            of_world.worst(Network, Case::force_share),
            of_world.worst(Network, Case::max_share),
            percent_or_none(inside),
            of_world.worst(LawWithDriveForce, Case::force_share),
            of_world.worst(Law, Case::force_share),
        ]
    };
    names.iter().map(row).collect()
}

fn value(verdict: &Verdict, value: f64) -> String {
    match verdict.unit {
        "share" => format!("{:.2} %", 100.0 * value),
        unit => format!("{value:.1} {unit}"),
    }
}

/// Decision and figures of a goal.
fn decision(verdict: &Verdict) -> (&'static str, String) {
    let (Some(met), Some(worst), Some(median)) = (verdict.met, &verdict.worst, verdict.median) else {
        return ("not decided", "no figure".into());
    };
    let worst_name =
        if matches!(verdict.limit, Limit::AtLeast(_) | Limit::Above(_)) { "least" } else { "worst" };
    let mut figures = format!("{worst_name} {} ({})", value(verdict, worst.value), worst.of);
    if verdict.figures > 1 {
        let count = format!("{} of {} within", verdict.within, verdict.figures);
        figures = format!("{figures}, median {}, {count}", value(verdict, median));
    }
    (if met { "met" } else { "not met" }, figures)
}

fn lead(outcome: &Outcome) -> String {
    let drawn = Selection::new(&outcome.cases, |case| case.set == Set::Drawn);
    let (network, law) = (drawn.spread(Network, Case::force_share), drawn.spread(Law, Case::force_share));
    let met = outcome.goals.iter().filter(|goal| goal.met == Some(true)).count();
    format!(
        "In {} drawn worlds of each operating point the estimated force is wrong by {} % rms of full scale \
         in the median and {} % in the worst world; with the analytic law in place of the networks by {} % \
         and {} %. {met} of {} goals met.",
        outcome.worlds,
        percent(network.median),
        percent(network.largest),
        percent(law.median),
        percent(law.largest),
        outcome.goals.len()
    )
}

/// Tables and goals on the terminal.
pub(super) fn print(outcome: &Outcome) {
    print_line!("{}\n", text_table(FORCE_HEADER, force_rows(outcome), 1));
    print_line!("{}\n", text_table(TORQUE_HEADER, torque_rows(outcome), 1));
    for set in [Set::SingleParameter, Set::Robustness] {
        print_line!("{}\n", text_table(WORLD_HEADER, world_rows(outcome, set), 1));
    }
    for verdict in &outcome.goals {
        let (decision, figures) = decision(verdict);
        print_line!("{decision}: {}\n  {figures}", verdict.goal);
    }
    print_line!("\n{}", lead(outcome));
}

/// The page.
pub(super) fn page(outcome: &Outcome, pictures: &Pictures, bench: &TransmissionBench) -> Page {
    let mut page = Page::new("The estimate in worlds that differ from the description");
    let row = |verdict: &Verdict| {
        let (decision, figures) = decision(verdict);
        vec![verdict.goal.to_owned(), figures, decision.to_owned()]
    };
    let (sensors, declared) = (Sensors::BENCH_B, Deviations::BENCH_B);
    page.lead(&lead(outcome));
    page.text(&format!(
        "The truth is an independent simulator. Sensors at 10 kHz with white noise: journal {:.1} um, angle \
         {:.0} urad, load {} N, drive force {} N. Standard deviations of a drawn world: clearance {:.0} um, \
         Young's modulus {} %, moment of inertia {} %, mass {} %, friction {} %, levers {} %. Errors count \
         from {} ms on.",
        1e6 * sensors.position_m,
        1e6 * sensors.angle_rad,
        sensors.load_force_n,
        sensors.drive_force_n,
        1e6 * declared.clearance_m,
        100.0 * declared.modulus_share,
        100.0 * declared.inertia_share,
        100.0 * declared.mass_share,
        100.0 * declared.friction_share,
        100.0 * declared.lever_share,
        1e3 * START_S,
    ));
    page.section("Goals")
        .table(&["goal", "figures", "decision"], &outcome.goals.iter().map(row).collect::<Vec<_>>());
    page.section("Exact and drawn worlds").table(&FORCE_HEADER, &force_rows(outcome));
    page.note(
        "Rms error of the force vector unless the heading says otherwise. In 2 sd: share of all ticks \
               of the drawn worlds, %.",
    );
    page.table(&TORQUE_HEADER, &torque_rows(outcome));
    for picture in &pictures.wide {
        page.figure(&picture.drawing, &picture.caption);
    }
    output::show(&mut page, &pictures.half);
    page.section("One parameter off by one declared deviation");
    page.table(&WORLD_HEADER, &world_rows(outcome, Set::SingleParameter));
    page.note("Over all operating points.");
    page.section("Effects that no description contains");
    page.table(&WORLD_HEADER, &world_rows(outcome, Set::Robustness));
    page.note(
        "Stribeck rise: friction coefficient larger by .06 at standstill, decaying over 10 mm/s. Correlated \
         noise: .9 from reading to reading. Position delay: 100 us along Y and Z. Law exponent: larger by \
         .15, about 20 um. Drive lag: 1 ms.",
    );
    page.note("worlds.json contains every case.");
    limits::section(&mut page, bench);
    page
}
