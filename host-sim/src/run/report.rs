//! Tables of a run, for the terminal and the page.

use super::{Finished, settled};
use crate::cli::label::label;
use crate::run::estimator_summary::{Differences, EstimatorSummary, Tracked};
use crate::run::impacts::{TABLE_HEADER, pairs, table_rows};
use crate::run::magnitude::number;
use crate::run::summary::{PeakRow, Sticking, Summary};
use bench::integrate::Impact;
use report::text_table;

/// A force, or `unknown` where it is not a number.
pub(super) fn or_unknown(force_n: f64) -> String {
    if force_n.is_nan() { "unknown".into() } else { format!("{force_n:.0} N") }
}

/// Rows with name and value, unit included.
pub(crate) fn rows(summary: &Summary) -> Vec<[String; 2]> {
    let row = |name: &str, value: String| [name.to_owned(), value];
    let figures = &summary.figures;
    let mut rows = vec![
        row(
            "bearing",
            format!("{}, {:.2} mm, {:+.1} kN", figures.bearing.name(), figures.clearance_mm, figures.load_kn),
        ),
        row("bearing force from", figures.force.name().into()),
        row("peak contact force", format!("{:.0} N", figures.peak_contact_force_n)),
        row("peak force along Y", format!("{:.0} N", figures.peak_force_y_n)),
        row("peak force along Z", format!("{:.0} N", figures.peak_force_z_n)),
        row("peak friction torque", format!("{:.1} N m", figures.peak_friction_torque_nm)),
        row("largest deformation", format!("{:.1} um", figures.max_deformation_m * 1e6)),
        row("oscillation, rms", or_unknown(figures.oscillation_rms_n)),
        row("periods in contact", figures.contacts.to_string()),
        row(
            "energy residual",
            figures.energy_residual_rel.map_or_else(|| "unknown".into(), |rel| format!("{rel:.1e}")),
        ),
        row("outside the training range", format!("{:.2} %", 100.0 * figures.outside_training_share)),
        row("wall time per simulated second", format!("{:.3} s", summary.wall_s_per_simulated_s)),
    ];
    if let Some(plant) = &summary.plant {
        let takes = if plant.inputs.is_empty() { "takes no force" } else { "takes the force" };
        rows.insert(2, row("plant", format!("{}, FMI {}, {takes}", plant.model, plant.fmi)));
    }
    let tolerance = summary.tolerance.map(|t| row("relative tolerance", format!("{t:.0e}")));
    let step = summary.communication_step_s.map(|s| row("communication step", format!("{:.1} us", 1e6 * s)));
    rows.extend(tolerance.into_iter().chain(step));
    if let Some(Sticking { count, total_s }) = figures.sticking {
        rows.push(row("sticking", format!("{count} times, {:.1} ms in total", 1e3 * total_s)));
    }
    if let Some(tilt) = &summary.tilt {
        rows.push(row("largest tilt of the shaft", format!("{:.2} mrad", 1e3 * tilt.largest_tilt_rad)));
        rows.push(row("largest edge load over the mean", format!("{:.2}", tilt.largest_edge_ratio)));
    }
    if let Some(servo) = &summary.servo {
        rows.push(row("servo, rms error of the position", format!("{:.2} mm", 1e3 * servo.rms_error_m)));
        rows.push(row("servo, largest error", format!("{:.2} mm", 1e3 * servo.largest_error_m)));
    }
    if let Some(law) = &summary.against_law {
        rows.push(row(
            "peak contact force of the analytic law",
            format!("{:.0} N", law.peak_contact_force_n),
        ));
        rows.push(row("rms difference from the law, force", format!("{:.0} N", law.force_rms_difference_n)));
        rows.push(row(
            "rms difference from the law, journal",
            format!("{:.2} um", law.journal_rms_difference_m * 1e6),
        ));
    }
    rows.extend(summary.estimator.iter().flat_map(estimator_rows));
    rows
}

/// Rows of the estimator.
fn estimator_rows(e: &EstimatorSummary) -> Vec<[String; 2]> {
    let row = |name: &str, value: String| [name.to_owned(), value];
    let mut rows = Vec::new();
    rows.push(row("estimator", e.controller.into()));
    rows.push(row("estimator, rms error of the force", format!("{:.0} N", e.force_rms_error_n)));
    rows.push(row(
        "estimator, rms error of full scale",
        format!("{:.2} %", 100.0 * e.force_rms_error_n / e.force_full_scale_n.max(1e-9)),
    ));
    rows.extend(tracked_rows(&e.tracked));
    rows.push(row(
        "estimator, outside the training range",
        format!("{:.2} %", 100.0 * e.outside_training_share),
    ));
    rows.push(row("estimator, suspect sensors or timing", format!("{:.2} %", 100.0 * e.suspect_share)));
    rows.push(row("estimator, ticks", e.ticks.to_string()));
    rows.push(row("estimator, deadline misses", e.deadline_misses.to_string()));
    if let (Some(least), Some(mean), Some(most)) =
        (e.instructions_per_tick_min, e.instructions_per_tick_mean, e.instructions_per_tick_max)
    {
        rows.push(row("estimator, instructions a tick", format!("{least} / {mean:.0} / {most}")));
    }
    rows.push(row("exchanges per second", format!("{:.0}", e.exchanges_per_s)));
    if let Some(differences) = e.native_emulated_bit_differences {
        rows.push(row("estimates that differ, native and emulated", differences.to_string()));
    }
    if let Some(differences) = e.native_attached_bit_differences {
        rows.push(row("estimates that differ, native and attached", differences.to_string()));
    }
    rows.push(row("impacts recorded", e.impacts.totals.records.to_string()));
    if e.impacts.totals.records > 0 {
        rows.push(row("impacts, largest peak", format!("{:.0} N", e.impacts.totals.largest_peak_n)));
    }
    if e.impacts.totals.lost > 0 {
        rows.push(row("impacts, lost records", e.impacts.totals.lost.to_string()));
    }
    if e.restarts > 0 {
        rows.push(row("restarts of the controller", e.restarts.to_string()));
    }
    rows
}

/// Rows of the estimate's deviations and of what was learnt about the bearing.
fn tracked_rows(tracked: &Tracked) -> [[String; 2]; 6] {
    let row = |name: &str, value: String| [name.to_owned(), value];
    let percent = |share: f64| format!("{:.1} %", 100.0 * share);
    [
        row("estimator, rms error of the friction torque", format!("{:.2} N m", tracked.torque_rms_error_nm)),
        row("estimator, force within two deviations", percent(tracked.inside_2sd)),
        row("estimator, torque within two deviations", percent(tracked.torque_inside_2sd)),
        row(
            "estimator, radial clearance at the end",
            format!("{:.2} +- {:.2} um", 1e6 * tracked.clearance_m, 1e6 * tracked.clearance_sd_m),
        ),
        row(
            "estimator, stiffness at the end",
            format!("{:.3} +- {:.3}", tracked.stiffness_factor, tracked.stiffness_sd),
        ),
        row(
            "estimator, friction at the end",
            format!("{:.3} +- {:.3}", tracked.friction_factor, tracked.friction_sd),
        ),
    ]
}

pub(super) const EQUIVALENCE_HEADER: [&str; 5] =
    ["estimates against", "force, rms, N", "force, most, N", "torque, rms, N m", "torque, most, N m"];

/// Differences of the estimates from the bench, the law and the float networks.
pub(super) fn equivalence_rows(e: &EstimatorSummary) -> Vec<Vec<String>> {
    let row = |name: &str, d: &Differences| {
        let figures = [d.force_rms_n, d.force_max_n, d.torque_rms_nm, d.torque_max_nm];
        std::iter::once(name.to_owned()).chain(figures.map(number)).collect()
    };
    vec![
        row("the bench", &e.against_truth),
        row("the described law, same contact", &e.against_law),
        row("the float networks, same contact", &e.against_float),
    ]
}

/// Counters of controller and line that are not zero.
pub(super) fn counted_rows(e: &EstimatorSummary) -> Vec<Vec<String>> {
    let of = |counts: serde_json::Result<serde_json::Value>, prefix: &str| -> Vec<Vec<String>> {
        let mut rows = Vec::new();
        flatten(prefix, &counts.unwrap_or_default(), &mut rows);
        rows
    };
    [of(serde_json::to_value(e.counters), "controller"), of(serde_json::to_value(e.losses), "line")].concat()
}

fn flatten(name: &str, value: &serde_json::Value, rows: &mut Vec<Vec<String>>) {
    match value {
        serde_json::Value::Object(fields) => {
            fields.iter().for_each(|(field, value)| {
                flatten(&format!("{name}, {}", field.replace('_', " ")), value, rows)
            });
        }
        value if value.as_u64() != Some(0) => rows.push(vec![name.into(), value.to_string()]),
        _ => {}
    }
}

/// Maximum number of contacts in the list.
const LISTED: usize = 30;

const IMPACT_HEADER: [&str; 7] = [
    "onset, s",
    "crank angle, deg",
    "approach speed, mm/s",
    "peak force, N",
    "deformation, um",
    "duration, ms",
    "energy lost, J",
];

/// The column `slice` is shown only on a bench with several slices.
pub(super) fn impact_header(finished: &Finished) -> Vec<&'static str> {
    let slice = (!finished.forced.tilting.is_empty()).then_some("slice");
    slice.into_iter().chain(IMPACT_HEADER).collect()
}

pub(super) fn impact_rows(finished: &Finished) -> Vec<Vec<String>> {
    let slices = !finished.forced.tilting.is_empty();
    let row = |i: &Impact| {
        let slice = slices.then(|| (i.contact + 1).to_string());
        let cells = [
            format!("{:.6}", i.onset_s),
            format!("{:.3}", i.angles.crank_rad.to_degrees()),
            format!("{:.3}", 1e3 * i.approach_speed_m_s),
            format!("{:.1}", i.peak_force_n),
            format!("{:.2}", 1e6 * i.max_deformation_m),
            i.duration_s().map_or_else(|| "to the end".into(), |d| format!("{:.3}", 1e3 * d)),
            number(i.energy_lost_j),
        ];
        slice.into_iter().chain(cells).collect()
    };
    finished.forced.run.impacts.iter().take(LISTED).map(row).collect()
}

/// Rows of the first recorded impacts beside their true contacts.
pub(super) fn recorded_rows(finished: &Finished) -> Vec<Vec<String>> {
    let Some(exchange) = &finished.exchange else { return Vec::new() };
    let run = &finished.forced.run;
    let mut rows = table_rows(&pairs(&exchange.impacts, &run.impacts, &run.samples));
    rows.truncate(LISTED);
    rows
}

pub(super) fn energy_rows(finished: &Finished) -> Vec<Vec<String>> {
    if finished.forced.plant.is_some() {
        return vec![vec!["balance".into(), "unknown: the plant is that of another program".into()]];
    }
    finished.forced.run.energy.terms().iter().map(|(name, value)| vec![label(name), number(*value)]).collect()
}

pub(super) fn peak_rows(summary: &Summary) -> Vec<Vec<String>> {
    let row = |source: &str, p: &PeakRow| {
        let bar = p.error_bar.map_or_else(|| "unknown".into(), |bar| format!("{bar:.1e}"));
        vec![source.into(), label(p.name), number(p.value), bar, format!("{:.4}", p.time_s)]
    };
    let own = summary.peaks.iter().map(|p| row(summary.figures.force.name(), p));
    own.chain(summary.law_peaks.iter().map(|p| row("law", p))).collect()
}

/// Prints energy balance, contacts and peaks with their error bars.
pub(crate) fn print_audit(finished: &Finished) {
    let table = |title: &str, header: &[&str], rows: Vec<Vec<String>>, texts: usize| {
        print_line!("\n{title}\n{}", text_table(header, rows, texts));
    };
    if let Some(estimator) = &finished.summary.estimator {
        table("estimates", &EQUIVALENCE_HEADER, equivalence_rows(estimator), 1);
        table("counted", &["what", "count"], counted_rows(estimator), 1);
    }
    table("energy", &["term", "value"], energy_rows(finished), 1);
    let recorded = recorded_rows(finished);
    if !recorded.is_empty() {
        table(
            "impacts that the controller recorded (all in estimated_impacts.csv)",
            &TABLE_HEADER,
            recorded,
            0,
        );
    }
    table("contacts (all in impacts.csv)", &impact_header(finished), impact_rows(finished), 0);
    table("peaks", &PEAK_HEADER, peak_rows(&finished.summary), 2);
    if let Some(found) = &finished.summary.settled {
        table(&settled::title(found), &settled::SHORT_HEADER, settled::short_rows(found), 1);
        print_line!("bands, ranges (rainflow) and pictures are in the report; every cycle in cycles.csv");
    }
}

pub(super) const PEAK_HEADER: [&str; 5] = ["force from", "peak", "value", "error bar", "at, s"];
