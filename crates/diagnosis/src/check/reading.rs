//! The readings of a channel by themselves: missing ones, outliers, the step between them.

use super::finding::{Finding, Severity};
use super::keep_rows;
use super::statistics::{range, scatter};
use crate::digits::four_digits;
use bench::log::LogError;
use bench::{Bench, Channel, MeasuredLog, Role};

/// Share of missing readings from which on an output is left out as a whole.
const MOST_MISSING: f64 = 0.2;
/// Scatter of its neighbours' prediction from which on a reading is an outlier.
const OUTLYING: f64 = 10.0;
/// The same from which on another channel shows that something happened.
const SUSPECT: f64 = 4.0;
/// Share of a channel's readings up to which they are outliers and not its way.
const MOST_OUTLIERS: f64 = 0.02;
/// The same as a count, which bounds the work.
const MOST_COUNTED: usize = 1000;
/// Readings in a row up to which they are isolated.
const MOST_IN_A_ROW: usize = 2;
/// Readings on either side whose scatter a reading is compared with.
const NEIGHBOURHOOD: usize = 25;
/// Readings on either side in which the simulation's own suddenness counts: impacts come a little early or late.
const SAME_TIME: usize = 25;
/// Readings on either side whose prediction a reading takes part in, with some gone.
const REACH: usize = 8;
/// Least that an outlier's usual error is taken for, as a share of the channel's range.
const LEAST_OUTLIER: f64 = 2e-4;
/// Times the range of all but the outermost readings beyond which the whole range is that of gross readings.
const GROSS: f64 = 10.0;
/// One in so many readings at either end is outermost.
const OUTERMOST: usize = 100;
/// Size from which on a number is a filler and no reading; products of smaller ones stay finite.
const FILLER: f64 = 1e100;
/// Readings for each value from which on a step is looked for.
const REPEATS: usize = 4;

fn is_reading(value: f64) -> bool {
    value.abs() < FILLER
}

/// Missing readings: their rows are left out, or the output that has hardly any. A log that would lose more than half of
/// its rows is refused.
pub(super) fn missing(log: &mut MeasuredLog, findings: &mut Vec<Finding>) -> Result<(), LogError> {
    let rows = log.time_s.len();
    let mut keep = vec![true; rows];
    let (mut dead, mut sparse) = (Vec::new(), Vec::new());
    for (&channel, values) in &log.channels {
        let count = values.iter().filter(|v| !is_reading(**v)).count();
        if count == 0 {
            continue;
        }
        let gone = count as f64 > MOST_MISSING * rows as f64 && channel.role() == Role::Output;
        let severity = if gone { Severity::Wrong } else { Severity::Doubtful };
        let found = format!("{count} of {rows} readings are missing");
        let finding = Finding::new(severity, &log.source, channel.name(), "missing-values", found)
            .cause("lost by the logger, or a sensor that was not always there")
            .evidence("missing", count as f64)
            .evidence("rows", rows as f64);
        if gone {
            dead.push(channel);
            findings.push(finding.done("left out the channel"));
        } else {
            sparse.push(format!("{channel} {count}"));
            keep.iter_mut().zip(values).for_each(|(k, v)| *k &= is_reading(*v));
            findings.push(finding.done("left out these rows"));
        }
    }
    for channel in dead {
        log.channels.remove(&channel);
    }
    let whole = keep.iter().filter(|k| **k).count();
    if 2 * whole < rows {
        return Err(LogError::Content {
            file: log.source.clone(),
            found: format!(
                "{whole} of {rows} rows with a reading of every channel (missing: {})",
                sparse.join(", ")
            ),
            expected: "at least half: channels of one rate, or brought to one before".into(),
        });
    }
    keep_rows(log, &keep);
    Ok(())
}

/// Isolated readings many times their neighbours' scatter away: rows to keep.
///
/// An impact is short too. What the simulation has nearby (`expected`), or another output has at the same time, is none.
pub(super) fn outliers<'a>(
    bench: &Bench,
    log: &MeasuredLog,
    role: Role,
    expected: impl Fn(Channel) -> Option<&'a [f64]>,
    findings: &mut Vec<Finding>,
) -> Vec<bool> {
    let mut keep = vec![true; log.time_s.len()];
    let of_role = log.channels.iter().filter(|(c, _)| c.role() == role);
    let channels: Vec<(Channel, Neighbours<'_>)> = of_role
        .filter_map(|(&channel, values)| {
            let declared = bench.sensors().get(&channel).map_or(0.0, bench::sensor::Sensor::floor);
            Some((channel, Neighbours::new(&log.time_s, values, expected(channel), declared)?))
        })
        .collect();
    for (channel, neighbours) in &channels {
        let elsewhere = |row: usize| {
            role == Role::Output && channels.iter().any(|(c, n)| c != channel && n.suspect_near(row))
        };
        let Some((found, largest)) = neighbours.outlying(elsewhere) else { continue };
        for row in &found {
            if let Some(keep) = keep.get_mut(*row) {
                *keep = false;
            }
        }
        let words = format!(
            "{} isolated readings up to {} {} off",
            found.len(),
            four_digits(largest),
            channel.unit()
        );
        findings.push(
            Finding::new(Severity::Doubtful, &log.source, channel.name(), "outliers", words)
                .cause("external interference, or a loose contact")
                .evidence("outliers", found.len() as f64)
                .evidence("rows", log.time_s.len() as f64)
                .evidence("largest", largest)
                .done("left out these rows"),
        );
    }
    keep
}

/// What the two good readings on either side predict by the cubic through them.
fn predicted(time_s: &[f64], values: &[f64], good: &[bool], row: usize) -> Option<f64> {
    let before = (0..row).rev().filter(|&i| good.get(i) == Some(&true)).take(2);
    let after = (row + 1..values.len()).filter(|&i| good.get(i) == Some(&true)).take(2);
    let near: Vec<(f64, f64)> =
        before.chain(after).filter_map(|i| Some((*time_s.get(i)?, *values.get(i)?))).collect();
    if near.len() < 4 {
        return None;
    }
    let t = *time_s.get(row)?;
    let term = |(j, &(tj, vj)): (usize, &(f64, f64))| {
        let others = near.iter().enumerate().filter(|(k, _)| *k != j);
        vj * others.map(|(_, (tk, _))| (t - tk) / (tj - tk)).product::<f64>()
    };
    Some(near.iter().enumerate().map(term).sum())
}

/// Readings against what their neighbours predict.
struct Neighbours<'a> {
    time_s: &'a [f64],
    values: &'a [f64],
    /// Reading less prediction.
    errors: Vec<f64>,
    /// What the errors usually are around a reading.
    usual: Vec<f64>,
}

impl<'a> Neighbours<'a> {
    fn new(time_s: &'a [f64], values: &'a [f64], expected: Option<&[f64]>, declared: f64) -> Option<Self> {
        let good = vec![true; values.len()];
        let errors: Vec<f64> = (0..values.len()).map(|row| error(time_s, values, &good, row)).collect();
        // A prediction scatters 1.39 times as much as a reading. Where readings are steps, half a step is no outlier.
        let inner = range(&inner(values));
        let whole = range(values);
        let floor = scatter(errors.iter().copied())
            .max(1.39 * declared)
            .max(step(values).unwrap_or_default())
            .max(LEAST_OUTLIER * if inner > 0.0 { whole.min(GROSS * inner) } else { whole });
        let of = |values: &[f64], row: usize, reach: usize| -> Vec<f64> {
            let to = (row + reach + 1).min(values.len());
            values.get(row.saturating_sub(reach)..to).unwrap_or_default().to_vec()
        };
        let own: Option<Vec<f64>> = expected
            .filter(|s| s.len() == values.len())
            .map(|s| (0..s.len()).map(|row| error(time_s, s, &good, row).abs()).collect());
        let usual = (0..values.len())
            .map(|row| {
                let around = scatter(of(&errors, row, NEIGHBOURHOOD).into_iter());
                let simulated =
                    own.as_ref().map_or(0.0, |e| of(e, row, SAME_TIME).into_iter().fold(0.0, f64::max));
                floor.max(around).max(simulated)
            })
            .collect();
        (floor > 0.0).then_some(Self { time_s, values, errors, usual })
    }

    fn share(&self, errors: &[f64], row: usize) -> f64 {
        errors.get(row).zip(self.usual.get(row)).map_or(0.0, |(e, l)| e.abs() / l)
    }

    /// Whether something happens here too.
    fn suspect_near(&self, row: usize) -> bool {
        (row.saturating_sub(1)..=row + 1).any(|i| self.share(&self.errors, i) > SUSPECT)
    }

    /// Rows of outliers and how far the largest is off.
    fn outlying(&self, elsewhere: impl Fn(usize) -> bool) -> Option<(Vec<usize>, f64)> {
        let rows = self.values.len();
        let most = ((MOST_OUTLIERS * rows as f64) as usize).clamp(1, MOST_COUNTED);
        let suspects: Vec<usize> =
            (0..rows).filter(|&row| self.share(&self.errors, row) > 0.5 * OUTLYING).collect();
        if suspects.len() > 10 * most {
            return None;
        }
        let worst = |errors: &[f64]| {
            let of = suspects.iter().map(|&row| (row, self.share(errors, row)));
            of.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, share)| *share > OUTLYING)
        };
        let (mut good, mut errors, mut found) = (vec![true; rows], self.errors.clone(), Vec::new());
        // The worst goes first: it spoils the predictions of its neighbours, which are then made anew.
        while let Some((row, _)) = worst(&errors) {
            found.push(row);
            if let Some(good) = good.get_mut(row) {
                *good = false;
            }
            for i in row.saturating_sub(REACH)..(row + REACH + 1).min(rows) {
                let there = good.get(i) == Some(&true);
                if let Some(e) = errors.get_mut(i) {
                    *e = if there { error(self.time_s, self.values, &good, i) } else { 0.0 };
                }
            }
        }
        found.sort_unstable();
        let alone: Vec<usize> = found
            .chunk_by(|a, b| b - a <= 1)
            .filter(|run| run.len() <= MOST_IN_A_ROW && !run.iter().any(|&row| elsewhere(row)))
            .flatten()
            .copied()
            .collect();
        if alone.is_empty() || alone.len() > most {
            return None;
        }
        let off = |&row: &usize| error(self.time_s, self.values, &good, row).abs();
        let largest = alone.iter().map(off).fold(0.0, f64::max);
        Some((alone, largest))
    }
}

fn error(time_s: &[f64], values: &[f64], good: &[bool], row: usize) -> f64 {
    predicted(time_s, values, good, row).zip(values.get(row)).map_or(0.0, |(p, v)| v - p)
}

/// The readings in ascending order without the outermost ones, among which gross readings are.
fn inner(values: &[f64]) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let outermost = sorted.len() / OUTERMOST;
    sorted.truncate(sorted.len() - outermost);
    sorted.split_off(outermost)
}

/// The step between readings, where they are all whole numbers of it apart; `None` too where hardly any differ.
pub(super) fn step(values: &[f64]) -> Option<f64> {
    let sorted = inner(values);
    let least = 1e-9 * range(&sorted);
    let steps: Vec<f64> =
        sorted.windows(2).filter_map(|w| Some(w.last()? - w.first()?)).filter(|d| *d > least).collect();
    let step = steps.iter().copied().reduce(f64::min)?;
    let off = steps.iter().filter(|d| (*d / step - (*d / step).round()).abs() > 0.02).count();
    (steps.len() * REPEATS <= values.len() && off * 100 <= steps.len()).then_some(step)
}

/// Coarse readings, for the reader.
pub(super) fn steps(bench: &Bench, log: &MeasuredLog, findings: &mut Vec<Finding>) {
    for (&channel, values) in &log.channels {
        // A load may well be constant, and a constant has no steps.
        let Some(step) = step(values).filter(|_| channel != Channel::LoadForce) else { continue };
        let declared = bench.sensors().get(&channel).map_or(0.0, bench::sensor::Sensor::floor);
        let coarse = declared > 0.0 && step > 4.0 * declared;
        let severity = if coarse { Severity::Doubtful } else { Severity::Note };
        findings.push(
            Finding::new(
                severity,
                &log.source,
                channel.name(),
                "quantised",
                format!("readings come in steps of {} {}", four_digits(step), channel.unit()),
            )
            .cause("the converter's resolution, or too few digits in the file")
            .evidence("step", step)
            .evidence("declared_noise", declared),
        );
    }
}
