//! Times of a log: order, sample rate, gaps, unit of the clock.

use super::column_mapping::scaled;
use super::finding::{Finding, Severity};
use super::motion::motion_of;
use super::rows::keep_rows;
use super::tuning;
use crate::data::cycles::phases;
use crate::statistics::{median, robust_deviation};
use bench::log::LogError;
use bench::log::TIME;
use bench::{Bench, MeasuredLog};

/// Units of clocks, in s, with their names.
const UNITS: [(f64, &str); 4] =
    [(1e-3, "milliseconds"), (1e-6, "microseconds"), (1e-9, "nanoseconds"), (60.0, "minutes")];

/// Brings times into strict order: removes rows without a time, repeated rows, and rows that go
/// back in time.
pub(super) fn correct_order(log: &mut MeasuredLog, findings: &mut Vec<Finding>) -> Result<(), LogError> {
    let rows = log.time_s.len();
    let (mut last, mut last_row) = (f64::NEG_INFINITY, 0);
    let (mut keep, mut no_time, mut repeated, mut same_time, mut back) = (vec![false; rows], 0, 0, 0, 0);
    for (row, &t) in log.time_s.iter().enumerate() {
        if !t.is_finite() {
            no_time += 1;
        } else if t > last {
            (last, last_row) = (t, row);
            if let Some(keep) = keep.get_mut(row) {
                *keep = true;
            }
        } else if t == last {
            let is_repeated = log
                .channels
                .values()
                .all(|v| v.get(row).map(|x| x.to_bits()) == v.get(last_row).map(|x| x.to_bits()));
            if is_repeated { repeated += 1 } else { same_time += 1 }
        } else {
            back += 1;
        }
    }
    let lost = no_time + same_time + back;
    if lost as f64 > tuning::MAX_LOST_SHARE * rows as f64 {
        return Err(LogError::Content {
            file: log.source.clone(),
            found: format!("{lost} of {rows} rows without a time, at the time of another row or before it"),
            expected: "times that ascend strictly: more digits, or one log per file".into(),
        });
    }
    let mut report = |count: usize, severity, kind, found: &str, cause: &str| {
        if count > 0 {
            findings.push(
                Finding::new(severity, &log.source, TIME, kind, format!("{count} of {rows} rows {found}"))
                    .cause(cause)
                    .evidence("rows", count as f64)
                    .applied("left out these rows"),
            );
        }
    };
    report(no_time, Severity::Doubtful, "missing-values", "have no time", "lost by the logger");
    report(repeated, Severity::Note, "duplicate-time", "repeat the row before", "written twice");
    report(
        same_time,
        Severity::Doubtful,
        "duplicate-time",
        "have the time of another row with other readings",
        "too few digits of time, or two sources in one file",
    );
    report(
        back,
        Severity::Doubtful,
        "backward-time",
        "go back in time",
        "the clock was set, or the rows are out of order",
    );
    keep_rows(log, &keep);
    Ok(())
}

/// Median interval between rows, s.
pub(super) fn interval_s(log: &MeasuredLog) -> f64 {
    median(log.time_s.windows(2).map(|w| w.last().zip(w.first()).map_or(0.0, |(b, a)| b - a)))
}

/// Finds and corrects a clock in another unit: the interval indicates the unit, and the motion must
/// agree. If the log shows no period and no velocity, the times stay as they are.
pub(super) fn correct_unit(bench: &Bench, log: &mut MeasuredLog, findings: &mut Vec<Finding>) {
    let described_s = 1.0 / bench.sample_rate_hz();
    let found_s = interval_s(log);
    let is_near =
        |seconds: f64, described: f64, max: f64| (seconds / described).max(described / seconds) < max;
    if found_s <= 0.0 || is_near(found_s, described_s, tuning::SUSPECT_RATE_RATIO) {
        return;
    }
    let Some((unit_s, name)) =
        UNITS.into_iter().find(|(u, _)| is_near(found_s * u, described_s, tuning::MAX_RATE_RATIO))
    else {
        return;
    };
    let Some(motion) = motion_of(bench, log) else { return };
    let period_s = period_s(&log.time_s, motion.value);
    let described_period_s = bench.period_s();
    // Position over integrated velocity equals the unit of the clock if only the clock is wrong.
    let ratio = motion.ratio(&log.time_s);
    let agreement = match (ratio, period_s) {
        (Some(r), _) => Some(is_near(r.abs(), unit_s, tuning::CLOCK_RATIO)),
        (None, Some(p)) => Some(is_near(p * unit_s, described_period_s, tuning::CLOCK_PERIOD_RATIO)),
        (None, None) => None,
    };
    if agreement == Some(false) {
        return;
    }
    let mut finding = Finding::new(
        if agreement.is_some() { Severity::Wrong } else { Severity::Doubtful },
        &log.source,
        TIME,
        "clock-unit",
        format!("the interval between rows is {found_s:.4}; the described one is {described_s:.4} s"),
    )
    .cause(format!(
        "the clock counts {name}{}",
        if agreement.is_some() { "" } else { ", or the log has another sample rate" }
    ))
    .evidence("interval", found_s)
    .evidence("described_interval_s", described_s)
    .evidence("position_over_integral_of_velocity", ratio.unwrap_or(f64::NAN))
    .evidence("period", period_s.unwrap_or(f64::NAN))
    .correction(scaled(bench, TIME, unit_s));
    if agreement.is_some() {
        finding = finding.applied(format!("multiplied the times by {unit_s:e}"));
        for t in &mut log.time_s {
            *t *= unit_s;
        }
    }
    findings.push(finding);
}

/// Mean period of a motion; `None` if it does not repeat.
fn period_s(time_s: &[f64], position: &[f64]) -> Option<f64> {
    let phase = phases(time_s, position)?;
    let cycles = phase.last()? - phase.first()?;
    Some((time_s.last()? - time_s.first()?) / cycles)
}

/// Reports sample rate, jitter and gaps.
pub(super) fn report_rate(log: &MeasuredLog, findings: &mut Vec<Finding>) {
    let middle = interval_s(log);
    if middle <= 0.0 {
        return;
    }
    let intervals = || log.time_s.windows(2).map(|w| w.last().zip(w.first()).map_or(0.0, |(b, a)| b - a));
    let jitter =
        robust_deviation(intervals().filter(|d| *d < tuning::GAP_INTERVALS * middle).map(|d| d - middle))
            / middle;
    let duration = log.time_s.last().zip(log.time_s.first()).map_or(0.0, |(b, a)| b - a);
    let note = |kind, found| Finding::new(Severity::Note, &log.source, TIME, kind, found);
    findings.push(
        note(
            "sampling",
            format!("{} rows in {duration:.3} s, {:.2} per second", log.time_s.len(), 1.0 / middle),
        )
        .evidence("rows", log.time_s.len() as f64)
        .evidence("rate_hz", 1.0 / middle)
        .evidence("jitter_share", jitter),
    );
    if jitter > tuning::JITTER_SHARE {
        findings.push(
            note("jitter", format!("the interval between rows scatters by {:.1} %", 100.0 * jitter))
                .cause("a logger without a hardware clock")
                .evidence("jitter_share", jitter),
        );
    }
    let gaps: Vec<f64> = intervals().filter(|d| *d > tuning::GAP_INTERVALS * middle).collect();
    if let Some(largest) = gaps.iter().copied().reduce(f64::max) {
        let lost: f64 = gaps.iter().map(|g| g - middle).sum();
        let mut finding =
            note("gap", format!("{} gaps, {lost:.3} s in all, the largest {largest:.3} s", gaps.len()))
                .cause("rows lost by the logger")
                .evidence("gaps", gaps.len() as f64)
                .evidence("lost_s", lost)
                .evidence("largest_s", largest);
        if lost > tuning::DOUBTFUL_GAP_SHARE * duration {
            finding.severity = Severity::Doubtful;
        }
        findings.push(finding);
    }
}
