//! Checks of a log before the diagnosis, so that faults of the log itself are reported and not
//! taken for effects of the bench.
//!
//! Copies of a log are left out first. Each other log is then checked in this order:
//!
//! 1. order of the times, missing readings, unit of the clock;
//! 2. sample rate and resolution, for information;
//! 3. outliers and contradictions of the inputs, the load;
//! 4. the outputs against the described bench under the log's inputs: exchanged axes, units and
//!    signs, factors of the geometry, stuck channels, outliers;
//! 5. contradictions of the outputs.
//!
//! Step 4 is left out where an axis' motion is simulated in open loop: a small error of the model
//! adds up there, so the simulated motion is no measure of a unit.
//!
//! A channel with a [`Severity::Wrong`] finding is corrected if an exact correction is known (a
//! unit, a sign, an exchange, a factor of the geometry), and is left out otherwise. Rows without a
//! time, with missing readings or with outliers are left out. The diagnosis itself names the small
//! gain, offset, delay or limit of a sensor, so these stay in the log.
//!
//! Limits: one factor per channel. Wear or friction may change a gain too, so a factor below
//! fourfold is corrected only if it is a known ratio and a related channel is right. A log whose
//! inputs are all wrong looks like a log of another bench.

mod axes;
mod clock;
mod column_mapping;
mod contradictions;
mod copies;
mod factors;
mod finding;
mod gains;
mod load;
mod missing;
mod motion;
mod open_loop;
mod outliers;
mod rail;
mod resolution;
mod rows;
mod simulated;
mod stuck;
mod tuning;
mod units;

pub use finding::{Finding, Severity};
pub(crate) use resolution::step;

use crate::data::logs::simulated_outputs;
use bench::log::LogError;
use bench::{Bench, MeasuredLog, Role};
use rows::keep_rows;

/// Checked logs and the findings in them.
pub(crate) struct Checked {
    pub(crate) logs: Vec<MeasuredLog>,
    pub(crate) held_out: Vec<MeasuredLog>,
    pub(crate) findings: Vec<Finding>,
}

/// Checks logs; the most severe findings come first.
pub(crate) fn check(
    bench: &Bench,
    logs: &[MeasuredLog],
    held_out: &[MeasuredLog],
) -> Result<Checked, LogError> {
    let mut findings = Vec::new();
    let logs = copies::leave_out_copies(logs, &[], &mut findings);
    let held_out = copies::leave_out_copies(held_out, &logs, &mut findings);
    let mut check_all = |logs: Vec<&MeasuredLog>| -> Result<Vec<MeasuredLog>, LogError> {
        logs.into_iter().map(|log| check_log(bench, log, &mut findings)).collect()
    };
    let (logs, held_out) = (check_all(logs)?, check_all(held_out)?);
    findings.sort_by_key(|f| f.severity);
    Ok(Checked { logs, held_out, findings })
}

/// Leaves out copies of logs, and rows without a time, with the time of another row or without a
/// reading. Values do not change.
pub(crate) fn clean(bench: &Bench, logs: &[MeasuredLog]) -> Result<Vec<MeasuredLog>, LogError> {
    let mut ignored = Vec::new();
    let mut logs: Vec<MeasuredLog> =
        copies::leave_out_copies(logs, &[], &mut ignored).into_iter().cloned().collect();
    for log in &mut logs {
        clock::correct_order(log, &mut ignored)?;
        missing::leave_out_missing(bench, log, &mut ignored)?;
    }
    Ok(logs)
}

/// Returns the log with corrections; an error if no output remains that can be compared.
fn check_log(bench: &Bench, log: &MeasuredLog, findings: &mut Vec<Finding>) -> Result<MeasuredLog, LogError> {
    let (simulated_before, first) = (simulated_outputs(bench, log), findings.len());
    let mut log = log.clone();
    clock::correct_order(&mut log, findings)?;
    missing::leave_out_missing(bench, &mut log, findings)?;
    clock::correct_unit(bench, &mut log, findings);
    clock::report_rate(&log, findings);
    resolution::report_resolution(bench, &log, findings);
    let interval_s = clock::interval_s(&log);
    let keep = outliers::find_outliers(bench, &log, Role::Input, |_| None, findings);
    keep_rows(&mut log, &keep);
    contradictions::check_inputs(bench, &mut log, interval_s, findings);
    if bench.is_open_loop() {
        findings.push(open_loop::not_judged(bench, &log));
        let no_outlier = outliers::find_outliers(bench, &log, Role::Output, |_| None, findings);
        keep_rows(&mut log, &no_outlier);
    } else if let Some(simulated) = load::check(bench, &mut log, findings) {
        axes::check(bench, &mut log, &simulated, findings);
        units::check(bench, &mut log, &simulated, findings);
        gains::check(bench, &mut log, &simulated, findings);
        let not_stuck = stuck::check(bench, &mut log, &simulated, findings);
        let expected = |c| simulated.channel(c);
        let no_outlier = outliers::find_outliers(bench, &log, Role::Output, expected, findings);
        let keep: Vec<bool> = not_stuck.into_iter().zip(no_outlier).map(|(a, b)| a && b).collect();
        keep_rows(&mut log, &keep);
    }
    if !simulated_before.is_empty() && simulated_outputs(bench, &log).is_empty() {
        let is_left_out = |f: &&Finding| {
            simulated_before.iter().any(|c| c.name() == f.channel) && f.severity == Severity::Wrong
        };
        let left_out = findings.iter().skip(first).filter(is_left_out);
        let reasons: Vec<String> =
            left_out.map(|f| format!("{}: {}, {}", f.channel, f.found, f.cause)).collect();
        return Err(LogError::Content {
            file: log.source,
            found: format!("no usable output ({})", reasons.join("; ")),
            expected: "at least one measured output that can be compared with the simulation".into(),
        });
    }
    contradictions::check_outputs(&log, interval_s, findings);
    Ok(log)
}

#[cfg(test)]
mod clean_log_tests;
#[cfg(test)]
mod reading_tests;
#[cfg(test)]
mod tests;
