//! The time of a log: order, rate, gaps, unit.

use super::finding::{Finding, Severity};
use super::keep_rows;
use super::mend::scaled;
use super::pairs::{Motion, motion_of};
use super::statistics::{median, scatter};
use crate::cycles::phases;
use bench::log::LogError;
use bench::log_format::TIME;
use bench::{Bench, MeasuredLog};

/// Share of rows that may be lost to times in disorder.
const MOST_LOST: f64 = 0.1;
/// Intervals, in middle ones, from which on rows are missing.
pub(super) const GAP: f64 = 2.5;
/// Share of the middle interval from which on the scatter of intervals is told.
const JITTER: f64 = 0.05;
/// Units that clocks count in.
const UNITS: [(f64, &str); 4] =
    [(1e-3, "milliseconds"), (1e-6, "microseconds"), (1e-9, "nanoseconds"), (60.0, "minutes")];
/// Largest factor between the described and the logged rate that is still the bench at another rate.
const RATE: f64 = 5.0;

/// Puts times into strict order: rows without a time, repeated rows and rows that go back are left out.
pub(super) fn order(log: &mut MeasuredLog, findings: &mut Vec<Finding>) -> Result<(), LogError> {
    let rows = log.time_s.len();
    let (mut last, mut last_row) = (f64::NEG_INFINITY, 0);
    let (mut keep, mut no_time, mut repeated, mut other, mut back) = (vec![false; rows], 0, 0, 0, 0);
    for (row, &t) in log.time_s.iter().enumerate() {
        if !t.is_finite() {
            no_time += 1;
        } else if t > last {
            (last, last_row) = (t, row);
            if let Some(keep) = keep.get_mut(row) {
                *keep = true;
            }
        } else if t == last {
            let same = log
                .channels
                .values()
                .all(|v| v.get(row).map(|x| x.to_bits()) == v.get(last_row).map(|x| x.to_bits()));
            if same { repeated += 1 } else { other += 1 }
        } else {
            back += 1;
        }
    }
    let lost = no_time + other + back;
    if lost as f64 > MOST_LOST * rows as f64 {
        return Err(LogError::Content {
            file: log.source.clone(),
            found: format!("{lost} of {rows} rows without a time, at the time of another row or before it"),
            expected: "times that ascend strictly: more digits, or one session a file".into(),
        });
    }
    let mut tell = |count: usize, severity, kind, found: &str, cause: &str| {
        if count > 0 {
            findings.push(
                Finding::new(severity, &log.source, TIME, kind, format!("{count} of {rows} rows {found}"))
                    .cause(cause)
                    .evidence("rows", count as f64)
                    .done("left out these rows"),
            );
        }
    };
    tell(no_time, Severity::Doubtful, "missing-values", "have no time", "lost by the logger");
    tell(repeated, Severity::Note, "duplicate-time", "repeat the row before", "written twice");
    tell(
        other,
        Severity::Doubtful,
        "duplicate-time",
        "have the time of another row with other readings",
        "too few digits of time, or two sources in one file",
    );
    tell(
        back,
        Severity::Doubtful,
        "backward-time",
        "go back in time",
        "a clock that was set, or rows out of order",
    );
    keep_rows(log, &keep);
    Ok(())
}

/// The middle interval, s.
pub(super) fn interval_s(log: &MeasuredLog) -> f64 {
    median(log.time_s.windows(2).map(|w| w.last().zip(w.first()).map_or(0.0, |(b, a)| b - a)))
}

/// A clock that counts in another unit: the interval says so, and the motion agrees. Where the motion tells nothing of time, the times
/// stay as they are.
pub(super) fn unit(bench: &Bench, log: &mut MeasuredLog, findings: &mut Vec<Finding>) {
    let described_s = match bench {
        Bench::Transmission(b) => 1.0 / b.logging.sample_rate_hz,
        Bench::FrictionRig(r) => 1.0 / r.logging.sample_rate_hz,
    };
    let found_s = interval_s(log);
    let near =
        |seconds: f64, described: f64, most: f64| (seconds / described).max(described / seconds) < most;
    if found_s <= 0.0 || near(found_s, described_s, 2.0 * RATE) {
        return;
    }
    let Some((unit_s, name)) = UNITS.into_iter().find(|(u, _)| near(found_s * u, described_s, RATE)) else {
        return;
    };
    let Some(motion) = motion_of(bench, log) else { return };
    let period_s = period_s(&log.time_s, motion.value);
    let described_period_s = match bench {
        Bench::Transmission(b) => b.drive.period_s,
        Bench::FrictionRig(r) => r.axis.period_s,
    };
    // Position over the integral of velocity: as small as the clock's unit if only the clock is wrong.
    let ratio = Motion::ratio(&motion, &log.time_s);
    let agrees = match (ratio, period_s) {
        (Some(r), _) => Some(near(r.abs(), unit_s, 1.3)),
        (None, Some(p)) => Some(near(p * unit_s, described_period_s, 10.0)),
        (None, None) => None,
    };
    if agrees == Some(false) {
        return;
    }
    let mut finding = Finding::new(
        if agrees.is_some() { Severity::Wrong } else { Severity::Doubtful },
        &log.source,
        TIME,
        "clock-unit",
        format!("{found_s:.4} from sample to sample; the described rate has {described_s:.4} s"),
    )
    .cause(format!(
        "the clock counts {name}{}",
        if agrees.is_some() { "" } else { ", or the log has another rate" }
    ))
    .evidence("interval", found_s)
    .evidence("described_interval_s", described_s)
    .evidence("position_over_integral_of_velocity", ratio.unwrap_or(f64::NAN))
    .evidence("period", period_s.unwrap_or(f64::NAN))
    .mend(scaled(bench, TIME, unit_s));
    if agrees.is_some() {
        finding = finding.done(format!("multiplied the times by {unit_s:e}"));
        for t in &mut log.time_s {
            *t *= unit_s;
        }
    }
    findings.push(finding);
}

fn period_s(time_s: &[f64], position: &[f64]) -> Option<f64> {
    let phase = phases(time_s, position)?;
    let cycles = phase.last()? - phase.first()?;
    Some((time_s.last()? - time_s.first()?) / cycles)
}

/// Rate, jitter and gaps, for the reader.
pub(super) fn rate(log: &MeasuredLog, findings: &mut Vec<Finding>) {
    let middle = interval_s(log);
    if middle <= 0.0 {
        return;
    }
    let intervals = || log.time_s.windows(2).map(|w| w.last().zip(w.first()).map_or(0.0, |(b, a)| b - a));
    let jitter = scatter(intervals().filter(|d| *d < GAP * middle).map(|d| d - middle)) / middle;
    let duration = log.time_s.last().zip(log.time_s.first()).map_or(0.0, |(b, a)| b - a);
    let note = |kind, found| Finding::new(Severity::Note, &log.source, TIME, kind, found);
    findings.push(
        note(
            "sampling",
            format!("{} rows in {duration:.3} s, {:.2} a second", log.time_s.len(), 1.0 / middle),
        )
        .evidence("rows", log.time_s.len() as f64)
        .evidence("rate_hz", 1.0 / middle)
        .evidence("jitter_share", jitter),
    );
    if jitter > JITTER {
        findings.push(
            note("jitter", format!("the interval scatters by {:.1} %", 100.0 * jitter))
                .cause("a logger that is not clocked")
                .evidence("jitter_share", jitter),
        );
    }
    let gaps: Vec<f64> = intervals().filter(|d| *d > GAP * middle).collect();
    if let Some(largest) = gaps.iter().copied().reduce(f64::max) {
        let lost: f64 = gaps.iter().map(|g| g - middle).sum();
        let mut finding =
            note("gap", format!("{} gaps, {lost:.3} s in all, the largest {largest:.3} s", gaps.len()))
                .cause("rows lost by the logger")
                .evidence("gaps", gaps.len() as f64)
                .evidence("lost_s", lost)
                .evidence("largest_s", largest);
        if lost > 0.2 * duration {
            finding.severity = Severity::Doubtful;
        }
        findings.push(finding);
    }
}
