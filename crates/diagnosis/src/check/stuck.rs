//! Readings that stand still while the bench moves: a constant channel, a stuck one, one at its rail.

use super::finding::{Finding, Severity};
use super::reading::step;
use super::simulated::Simulated;
use super::statistics::{median, range, runs, scatter};
use bench::{Bench, MeasuredLog};
use std::ops::Range;

/// Equal readings in a row from which on a channel stands still.
const LEAST_RUN: usize = 8;
/// Floors of noise that the simulation has to move meanwhile.
const MOVED: f64 = 8.0;
/// Readings at the end of a channel's range, and in a row, from which on it is a rail.
const LEAST_RAILED: usize = 5;
const LEAST_RAILED_RUN: usize = 3;
/// Share of them in which the simulation goes beyond.
const BEYOND: f64 = 0.7;
/// The same where the channel comes to it again and again.
const BEYOND_OFTEN: f64 = 0.4;
/// Share of the readings at a rail at which the bench may be inside of it.
const INSIDE: f64 = 0.1;
/// Share of stuck readings from which on a channel is left out.
const MOST_STUCK: f64 = 0.05;
/// Steps of a coarse channel that the simulation has to move meanwhile: within one a reading stands still by right.
const STEPS: f64 = 1.5;
/// Least movement that counts, as a share of the simulated range.
const LEAST_MOVED: f64 = 0.02;

/// Looks at every output, leaves out channels with many stuck readings, and says which rows to keep for the others.
pub(super) fn check(
    bench: &Bench,
    log: &mut MeasuredLog,
    simulated: &Simulated,
    findings: &mut Vec<Finding>,
) -> Vec<bool> {
    let mut keep = vec![true; log.time_s.len()];
    let mut dead = Vec::new();
    for (channel, values) in log.outputs() {
        let Some(expected) = simulated.of(channel) else { continue };
        let declared = bench.sensors().get(&channel).map_or(0.0, bench::sensor::Sensor::floor);
        let coarse = STEPS * step(values).unwrap_or_default();
        let moved = (MOVED * declared).max(LEAST_MOVED * range(expected)).max(coarse);
        let note = |severity, kind, found: String, cause: &str| {
            Finding::new(severity, &log.source, channel.name(), kind, found).cause(cause)
        };
        let span = range(values);
        let steady = expected.get(simulated.steady()).unwrap_or_default();
        if span == 0.0 {
            if range(steady) > moved && scatter(steady.iter().copied()) > 0.0 {
                let found = format!("every reading is {}", values.first().copied().unwrap_or_default());
                findings.push(
                    note(
                        Severity::Wrong,
                        "constant",
                        found,
                        "a sensor that is not connected, or a column of another kind",
                    )
                    .evidence("simulated_range", range(steady))
                    .done("left out the channel"),
                );
                dead.push(channel);
            }
            continue;
        }
        let margin = 4.0 * declared;
        let railed: usize =
            [1.0, -1.0].into_iter().filter_map(|sign| rail(values, expected, sign, margin)).sum();
        let still = || runs(values).filter(|(_, length)| *length >= LEAST_RUN);
        let comes_back =
            |value: f64| still().filter(|(from, _)| values.get(*from) == Some(&value)).count() > 1;
        let (mut stuck, mut longest, mut clipped) = (Vec::new(), 0, 0);
        for (from, length) in still() {
            let run = from..from + length;
            let (Some(meanwhile), Some(&value)) = (expected.get(run.clone()), values.get(from)) else {
                continue;
            };
            if range(meanwhile) < moved {
                continue;
            }
            // One rail seen, the other one may be hidden by what the bench does there. Nor does a sensor hang twice at the very end of what it reads.
            if let Some(sign) = end(values, value)
                && (railed > 0
                    || comes_back(value)
                    || is_clipped(values, expected, run.clone(), sign, margin))
            {
                clipped += length;
                continue;
            }
            longest = longest.max(length);
            stuck.push(run);
        }
        let railed = if railed > 0 { railed } else { clipped };
        if railed > 0 {
            findings.push(
                note(
                    Severity::Doubtful,
                    "saturated",
                    format!("{railed} readings at the end of its range"),
                    "the sensor's or the amplifier's range is too small",
                )
                .evidence("readings", railed as f64),
            );
        }
        let count: usize = stuck.iter().map(Range::len).sum();
        if count == 0 {
            continue;
        }
        let gone = count as f64 > MOST_STUCK * values.len() as f64;
        let severity = if gone { Severity::Wrong } else { Severity::Doubtful };
        let found = format!("{count} readings stand still while the bench moves");
        let finding =
            note(severity, "stuck", found, "a logger that repeats its last value, or a sensor that hangs")
                .evidence("readings", count as f64)
                .evidence("longest", longest as f64);
        if gone {
            dead.push(channel);
            findings.push(finding.done("left out the channel"));
        } else {
            for row in stuck.into_iter().flatten() {
                if let Some(keep) = keep.get_mut(row) {
                    *keep = false;
                }
            }
            findings.push(finding.done("left out these rows"));
        }
    }
    log.channels.retain(|c, _| !dead.contains(c));
    keep
}

/// At which end of the readings a value is: 1 at the top, -1 at the bottom.
fn end(values: &[f64], value: f64) -> Option<f64> {
    [1.0, -1.0].into_iter().find(|sign| values.iter().all(|v| sign * v <= sign * value))
}

/// Whether a run at an end of the readings ends when the bench comes back there, as at a rail; a sensor that hangs does not wait for that.
fn is_clipped(values: &[f64], expected: &[f64], run: Range<usize>, sign: f64, margin: f64) -> bool {
    let most = INSIDE * run.len() as f64;
    let inside = passed(values, expected, run).into_iter().filter(|off| -sign * off > margin).count();
    inside as f64 <= most
}

/// By how much the bench would have gone beyond a run of equal readings: the simulation, moved to the readings before and behind the run.
fn passed(values: &[f64], expected: &[f64], run: Range<usize>) -> Vec<f64> {
    let off = |places: Range<usize>| {
        let beside = values.get(places.clone()).zip(expected.get(places)).filter(|(v, _)| !v.is_empty());
        beside.map(|(v, s)| median(v.iter().zip(s).map(|(v, s)| v - s)))
    };
    let before = off(run.start.saturating_sub(LEAST_RUN)..run.start);
    let behind = off(run.end..(run.end + LEAST_RUN).min(values.len()));
    let [before, behind] = [before.or(behind), behind.or(before)].map(Option::unwrap_or_default);
    let value = values.get(run.start).copied().unwrap_or_default();
    let (start, span) = (run.start as f64, run.len() as f64);
    let moved = |i: usize, s: &f64| s + before + (behind - before) * (i as f64 - start) / span - value;
    run.filter_map(|i| Some(moved(i, expected.get(i)?))).collect()
}

/// How often the largest reading (smallest for a negative sign) occurs, where the bench goes beyond it.
fn rail(values: &[f64], expected: &[f64], sign: f64, margin: f64) -> Option<usize> {
    let value = sign * values.iter().map(|v| sign * v).fold(f64::NEG_INFINITY, f64::max);
    let there = || values.iter().zip(expected).filter(|(v, _)| **v == value);
    let count = there().count();
    let beyond = there().filter(|(_, s)| sign * (**s - value) > margin).count();
    let runs: Vec<usize> =
        runs(values).filter(|(from, _)| values.get(*from) == Some(&value)).map(|(_, n)| n).collect();
    // A sensor that hangs does not come back to the same reading again and again.
    let often = runs.iter().filter(|n| **n >= LEAST_RAILED_RUN).count() >= LEAST_RAILED_RUN;
    let share = if often { BEYOND_OFTEN } else { BEYOND };
    let railed = count >= LEAST_RAILED
        && runs.iter().any(|n| *n >= LEAST_RAILED_RUN)
        && beyond as f64 >= share * count as f64;
    railed.then_some(count)
}
