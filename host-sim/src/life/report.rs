//! Tables, text and page of a life.

use super::pictures::Pictures;
use super::{LifeResult, Outcome, interval_m};
use crate::cli::error::CliError;
use crate::cli::limits;
use crate::cli::output;
use crate::sweep::table;
use bench::description::TransmissionBench;
use bench::life::foundation::cell_angle_rad;
use bench::simulate::life::LifePoint;
use report::page::Page;
use serde::Serialize;
use std::fmt::Write as _;

/// Point of the life with the interval of its clearance.
#[derive(Serialize)]
struct Row {
    #[serde(flatten)]
    point: LifePoint,
    clearance_low_m: f64,
    clearance_high_m: f64,
}

/// The course with its interval as CSV.
pub(crate) fn life_csv(result: &LifeResult) -> Result<String, CliError> {
    let row = |point: &LifePoint| {
        let limit_m = result.outcome.limit_clearance_m;
        let [clearance_low_m, clearance_high_m] = interval_m(&result.lives, limit_m, point.cycle);
        Row { point: *point, clearance_low_m, clearance_high_m }
    };
    table::csv(&result.lives[1].points.iter().map(row).collect::<Vec<_>>())
}

/// The profiles of bearing and journal at some cycles as CSV.
pub(crate) fn profile_csv(result: &LifeResult) -> String {
    let mut csv = String::from("cycle,angle_rad,bearing_depth_m,journal_depth_m\n");
    let life = &result.lives[1];
    for index in result.shown_points() {
        let (Some(point), Some(profile)) = (life.points.get(index), life.profiles.get(index)) else {
            continue;
        };
        for (cell, (bearing, journal)) in profile.bearing_m.iter().zip(&profile.journal_m).enumerate() {
            let _ = writeln!(csv, "{},{},{bearing},{journal}", point.cycle, cell_angle_rad(cell));
        }
    }
    csv
}

fn micrometres(value_m: f64) -> String {
    format!("{:.1} um", value_m * 1e6)
}

/// A number of cycles, or what it means that there is none.
fn cycles(value: Option<f64>) -> String {
    value.map_or_else(|| "not reached".into(), |cycle| format!("{cycle:.3e}"))
}

/// Figures as rows of name and value.
pub(crate) fn rows(result: &LifeResult) -> Vec<[String; 2]> {
    let outcome = &result.outcome;
    let last = outcome.points.last();
    let row = |name: &str, value: String| [name.to_owned(), value];
    let [low, high] = outcome.clearance_ci95_m.map(micrometres);
    let mut rows = vec![
        row("bearing", outcome.bearing.into()),
        row("specific wear rate, m3/(N m)", format!("{:.3e}", outcome.specific_wear_rate_m3_nm)),
        row("cycles", format!("{:.3e}", outcome.cycles)),
        row("radial clearance, new", micrometres(outcome.described_clearance_m)),
        row("radial clearance, worn", micrometres(outcome.clearance_m)),
        row(
            &format!("interval (wear rate times or over {})", outcome.wear_factor),
            format!("{low} to {high}"),
        ),
        row("limit of the radial clearance", micrometres(outcome.limit_clearance_m)),
        row("cycles to the limit", cycles(outcome.limit_cycle)),
        row("earliest", cycles(outcome.limit_cycle_earliest)),
        row("latest", cycles(outcome.limit_cycle_latest)),
        row("duties computed", outcome.computed_duties.to_string()),
        row("clearance-wear: clearance_increase_m", format!("{:.4e}", outcome.clearance_increase_m)),
    ];
    if let Some(point) = last {
        rows.push(row("worn volume", format!("{:.2} cm3", point.wear_volume_m3 * 1e6)));
        rows.push(row("share of the force on the film", format!("{:.3} %", 100.0 * point.film_share)));
    }
    if let Some(tracked) = outcome.tracked.last() {
        let tracked = tracked.clearance_m.zip(tracked.clearance_sd_m).map_or_else(
            || "not tracked".into(),
            |(found, sd)| format!("{} +- {}", micrometres(found), micrometres(sd)),
        );
        rows.push(row("tracked by the controller", tracked));
    }
    rows
}

/// Builds the page.
///
/// `is_written` states that there is a bench with the effect.
pub(crate) fn page(
    result: &LifeResult,
    pictures: &Pictures,
    bench: &TransmissionBench,
    is_written: bool,
) -> Page {
    let outcome = &result.outcome;
    let mut page = Page::new("Life of the bearing");
    let [low, high] = outcome.clearance_ci95_m.map(micrometres);
    page.lead(&format!(
        "{}, wear rate {:.2e} m3/(N m): after {:.2e} cycles the radial clearance has changed from {} to \
         {} (95 % interval {low} to {high}).",
        outcome.bearing,
        outcome.specific_wear_rate_m3_nm,
        outcome.cycles,
        micrometres(outcome.described_clearance_m),
        micrometres(outcome.clearance_m),
    ));
    page.note(&format!(
        "The interval is that of the wear rate alone, which is known to a factor of {}. The lives with the \
         rate times and over this factor end at their own limits.",
        outcome.wear_factor
    ));
    let table: Vec<Vec<String>> = rows(result).into_iter().map(Vec::from).collect();
    page.section("Figures").table(&["quantity", "value"], &table);
    page.section("Predicted and tracked clearance");
    for picture in &pictures.clearance {
        page.figure(&picture.drawing, &picture.caption);
    }
    page.note(
        "The tracked clearance is that of the controller's estimator in this process, from noisy sensors of \
         the bench with the predicted clearance. It starts each time from the clearance tracked before.",
    );
    page.section("Worn profile");
    output::show(&mut page, &pictures.profiles);
    page.section("Duty cycle over the life");
    output::show(&mut page, &pictures.duty);
    page.section("As an effect");
    page.text(&effect(outcome, is_written));
    page.section("What a life leaves out").list(&[
        "The plant has a round clearance, the mean in the directions of the contact; the profile determines \
         the pressure alone.",
        "The wear rate is constant: no running-in, no transition, no debris.",
        "The film carries a part of the force; it changes neither the motion nor the friction of a run.",
        "The lining is an elastic foundation; its pockets have no stress peaks at their edges.",
        "The lining grows by heat and water as if it were free; bonded to a stiff housing it grows in \
         thickness by up to (1 + nu)/(1 - nu) of that.",
    ]);
    page.text("The runs of its duty cycles are those of host-sim run, with these limits:");
    limits::section(&mut page, bench);
    page
}

/// The change as an effect, in words.
pub(crate) fn effect(outcome: &Outcome, is_written: bool) -> String {
    let increase_m = outcome.clearance_increase_m;
    if is_written {
        return format!(
            "worn-bench.toml is the bench with the effect clearance-wear, clearance_increase_m = \
             {increase_m:e}. record, run and diagnose take it."
        );
    }
    format!(
        "worn-bench.toml is not written: a change of {} lies outside the range of the effect clearance-wear.",
        micrometres(increase_m)
    )
}
