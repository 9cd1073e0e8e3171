//! Constant readings while the bench moves: a constant channel, a stuck one, or one at a rail.

use super::finding::{Finding, Severity};
use super::rail::{Compared, end_of_range, equal_runs};
use super::resolution::step;
use super::simulated::Simulated;
use super::tuning;
use crate::statistics::{range, robust_deviation};
use bench::{Bench, Channel, MeasuredLog};
use std::ops::Range;

/// Checks every output, leaves out channels with many stuck readings, and returns for each row
/// whether to keep it.
pub(super) fn check(
    bench: &Bench,
    log: &mut MeasuredLog,
    simulated: &Simulated,
    findings: &mut Vec<Finding>,
) -> Vec<bool> {
    let mut keep = vec![true; log.time_s.len()];
    let mut left_out = Vec::new();
    for channel in bench.outputs(log) {
        let (Some(values), Some(expected)) = (log.channels.get(&channel), simulated.channel(channel)) else {
            continue;
        };
        let declared = bench.sensors().get(&channel).map_or(0.0, bench::signals::Sensor::floor);
        let steps = tuning::MOVED_STEPS * step(values).unwrap_or_default();
        let share = tuning::MIN_MOVED_SHARE * range(expected);
        let min_moved = (tuning::MOVED_SIGMAS * declared).max(share).max(steps);
        let report = Report { source: &log.source, channel };
        if range(values) == 0.0 {
            let steady = expected.get(simulated.steady()).unwrap_or_default();
            if range(steady) > min_moved && robust_deviation(steady.iter().copied()) > 0.0 {
                findings.push(report.constant(values, range(steady)));
                left_out.push(channel);
            }
            continue;
        }
        let compared = Compared { values, expected, margin: tuning::RAIL_SIGMAS * declared };
        let ConstantRuns { rail_readings, stuck } = ConstantRuns::find(&compared, min_moved);
        if rail_readings > 0 {
            findings.push(report.saturated(rail_readings));
        }
        let count: usize = stuck.iter().map(Range::len).sum();
        if count == 0 {
            continue;
        }
        let is_left_out = count as f64 > tuning::MAX_STUCK_SHARE * values.len() as f64;
        findings.push(report.stuck(&stuck, is_left_out));
        if is_left_out {
            left_out.push(channel);
        } else {
            for row in stuck.into_iter().flatten() {
                if let Some(keep) = keep.get_mut(row) {
                    *keep = false;
                }
            }
        }
    }
    log.channels.retain(|c, _| !left_out.contains(c));
    keep
}

/// Runs of constant readings of a channel that changes elsewhere.
struct ConstantRuns {
    /// Number of readings at a rail.
    rail_readings: usize,
    /// Runs that no rail explains.
    stuck: Vec<Range<usize>>,
}

impl ConstantRuns {
    /// Finds runs during which the simulation moves by `min_moved` or more.
    fn find(compared: &Compared<'_>, min_moved: f64) -> Self {
        let Compared { values, expected, .. } = *compared;
        let rail_readings = compared.rail_readings();
        let long = || equal_runs(values).filter(|(_, length)| *length >= tuning::MIN_RUN);
        let is_repeated =
            |value: f64| long().filter(|(from, _)| values.get(*from) == Some(&value)).count() > 1;
        let (mut stuck, mut clipped) = (Vec::new(), 0);
        for (from, length) in long() {
            let run = from..from + length;
            let (Some(meanwhile), Some(&value)) = (expected.get(run.clone()), values.get(from)) else {
                continue;
            };
            if range(meanwhile) < min_moved {
                continue;
            }
            // If one rail is known, the described bench may not reach the other. A sensor is not
            // stuck twice at the same end.
            if let Some(sign) = end_of_range(values, value)
                && (rail_readings > 0 || is_repeated(value) || compared.is_clipped(run.clone(), sign))
            {
                clipped += length;
            } else {
                stuck.push(run);
            }
        }
        Self { rail_readings: if rail_readings > 0 { rail_readings } else { clipped }, stuck }
    }
}

/// Findings about one channel of a log.
struct Report<'a> {
    source: &'a str,
    channel: Channel,
}

impl Report<'_> {
    fn finding(&self, severity: Severity, kind: &'static str, found: String, cause: &str) -> Finding {
        Finding::new(severity, self.source, self.channel.name(), kind, found).cause(cause)
    }

    fn constant(&self, values: &[f64], simulated_range: f64) -> Finding {
        let found = format!("every reading is {}", values.first().copied().unwrap_or_default());
        let cause = "the sensor is not connected, or the column holds another signal";
        self.finding(Severity::Wrong, "constant", found, cause)
            .evidence("simulated_range", simulated_range)
            .applied("left out the channel")
    }

    fn saturated(&self, readings: usize) -> Finding {
        let found = format!("{readings} readings are at the end of its range");
        let cause = "the range of the sensor or the amplifier is too small";
        self.finding(Severity::Doubtful, "saturated", found, cause).evidence("readings", readings as f64)
    }

    fn stuck(&self, runs: &[Range<usize>], is_left_out: bool) -> Finding {
        let count: usize = runs.iter().map(Range::len).sum();
        let longest = runs.iter().map(Range::len).max().unwrap_or_default();
        let severity = if is_left_out { Severity::Wrong } else { Severity::Doubtful };
        let found = format!("{count} readings are constant while the bench moves");
        let cause = "a logger that repeats its last value, or a sensor that hangs";
        self.finding(severity, "stuck", found, cause)
            .evidence("readings", count as f64)
            .evidence("longest", longest as f64)
            .applied(if is_left_out { "left out the channel" } else { "left out these rows" })
    }
}
