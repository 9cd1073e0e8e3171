//! Settled operation of a run of several cycles: table, page section and file of its cycles.

use super::force::SAMPLE_RATE_HZ;
use super::magnitude::number;
use crate::cli::label::label;
use bench::description::TransmissionBench;
use bench::simulate::Run;
use bench::simulate::settled::{Course, Quantity, RangeCount, Settled};
use bench::statistics::Estimate;
use report::figure::{Chart, Series, lines};
use report::page::Page;

/// File with all quantities of every cycle.
pub(crate) const FILE_NAME: &str = "cycles.csv";

/// Describes the settled operation of a run; none with fewer than three cycles. The seed is that of
/// the intervals.
pub(crate) fn describe(bench: &TransmissionBench, run: &Run, seed: u64) -> Option<Settled> {
    let course =
        Course::new(run, SAMPLE_RATE_HZ, bench.drive.period_s, bench.duration_s(), bench.load.ramp_s);
    Settled::from_course(&course, seed)
}

/// Title of the table: the cycles that count.
pub(crate) fn title(settled: &Settled) -> String {
    let warning = if settled.is_settled { "" } else { ", perhaps not yet settled: run more cycles" };
    format!(
        "settled operation: cycles {} to {} of {} s{warning}",
        settled.transient_cycles + 1,
        settled.cycles,
        number(settled.cycle_s)
    )
}

/// Columns of the table of quantities.
const HEADER: [&str; 8] =
    ["quantity", "cycle 1", "mean", "95 %", "median", "90 % quantile", "largest", "in 1000 cycles"];

/// Interval of an estimate.
fn interval(estimate: &Estimate) -> String {
    estimate
        .interval
        .map_or_else(|| "too few cycles".into(), |[low, high]| format!("{} to {}", number(low), number(high)))
}

/// Estimate with its interval.
fn with_interval(estimate: &Estimate) -> String {
    match estimate.interval {
        Some(_) => format!("{} ({})", number(estimate.value), interval(estimate)),
        None => number(estimate.value),
    }
}

/// Columns of the table for the terminal.
pub(crate) const SHORT_HEADER: [&str; 6] = ["quantity", "cycle 1", "mean", "95 %", "smallest", "largest"];

/// Rows of the table for the terminal: bands and ranges are in the report.
pub(crate) fn short_rows(settled: &Settled) -> Vec<Vec<String>> {
    let quantities = settled.quantities.iter().filter(|q| !q.name.ends_with("_hz_n"));
    let row = |q: &Quantity| {
        vec![
            label(&q.name),
            number(q.first_cycle),
            number(q.mean.value),
            interval(&q.mean),
            number(q.smallest),
            number(q.largest),
        ]
    };
    quantities.map(row).collect()
}

/// Rows of the table of quantities.
fn rows(settled: &Settled) -> Vec<Vec<String>> {
    let row = |q: &Quantity| {
        let many = q.largest_in_1000.as_ref().map_or_else(String::new, with_interval);
        vec![
            label(&q.name),
            number(q.first_cycle),
            number(q.mean.value),
            interval(&q.mean),
            number(q.median.value),
            number(q.quantile_90.value),
            number(q.largest),
            many,
        ]
    };
    settled.quantities.iter().map(row).collect()
}

/// Columns of the table of ranges.
const RANGE_HEADER: [&str; 4] = ["history", "range", "per cycle", "95 %"];

/// Rows of the table of ranges: equivalent ranges, then the numbers by size. Sizes that never occur
/// are left out.
fn range_rows(settled: &Settled) -> Vec<Vec<String>> {
    let of_history = |count: &RangeCount| {
        let equivalent = |exponent: u32, estimate: &Estimate| {
            vec![
                label(count.name),
                format!("equivalent, exponent {exponent}: {}", number(estimate.value)),
                "1".to_owned(),
                interval(estimate),
            ]
        };
        let bins = count.bins.iter().filter(|bin| bin.per_cycle.value > 0.0).map(|bin| {
            let range = format!("{} to {}", number(bin.from), number(bin.to));
            vec![label(count.name), range, number(bin.per_cycle.value), interval(&bin.per_cycle)]
        });
        [equivalent(3, &count.equivalent_range_3), equivalent(5, &count.equivalent_range_5)]
            .into_iter()
            .chain(bins)
            .collect::<Vec<_>>()
    };
    settled.rainflow.iter().flat_map(of_history).collect()
}

/// Adds the section of settled operation.
pub(crate) fn section(page: &mut Page, settled: &Settled) -> Result<(), String> {
    page.section("Settled operation");
    page.note(&format!(
        "{} cycles of {} s, of which the first {} count as transient. Rule: {}.",
        settled.cycles,
        number(settled.cycle_s),
        settled.transient_cycles,
        settled.rule
    ));
    if !settled.is_settled {
        page.note("The transient may be longer than half the run: more cycles are needed.");
    }
    let over_cycles = |name: &str, label: &str| {
        let values = settled.values(name).unwrap_or_default();
        Series::through(label, values.iter().enumerate().map(|(i, v)| (i as f64 + 1.0, *v)).collect())
    };
    let chart = |title, y| Chart { title, x: "cycle", y, size: (500, 320) };
    page.figures(&[
        (
            lines(
                &chart("Peak contact force by cycle", "N"),
                &[over_cycles("peak_contact_force_n", "peak contact force")],
            )?,
            "Largest normal force of each cycle; in the first one after the load's ramp.",
        ),
        (
            lines(
                &chart("Oscillation by cycle", "N"),
                &[over_cycles("oscillation_rms_n", "rms above 3 Hz")],
            )?,
            "Rms of the normal force above 3 Hz in each cycle.",
        ),
    ]);
    page.table(&HEADER, &rows(settled));
    page.note(
        "One value per cycle. Intervals are those of a block bootstrap over the settled cycles. \"In 1000 \
         cycles\" is the largest value to expect by a Gumbel distribution of the cycles' peaks. Oscillation: \
         rms of the normal force above 3 Hz and in bands. cycles.csv contains every cycle.",
    );
    page.table(&RANGE_HEADER, &range_rows(settled));
    page.note(
        "Rainflow counts (ASTM E1049). The equivalent range, once per cycle, damages as all ranges together \
         by Miner's rule with the exponent given. Ranges below 1 % of the largest are not listed.",
    );
    Ok(())
}
