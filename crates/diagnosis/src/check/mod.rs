//! Reading and checking a log, the first step of a diagnosis: what cannot be right is named, not fitted away.
//!
//! Copies of a log are left out first. In this order, for each other log: times into order, missing readings, the clock's unit, outliers and contradictions of the inputs, the load; then
//! the outputs against the described bench under the log's inputs: swapped axes, units and signs, factors of the geometry,
//! channels that stand still, outliers; at last what the reader shall know (rate, gaps, resolution).
//!
//! What happens to what is [`Severity::Wrong`]: where an exact correction has a name (a unit, a sign, an exchange, a factor of the
//! geometry) the data are corrected for this diagnosis and the finding says so; else the channel is left out. Rows without
//! a time, with missing or outlying readings are left out. Nothing is done about the rest: a sensor's small gain, offset,
//! delay or limit is for the diagnosis to name.
//!
//! Limits: one factor a channel; a gain that a wear or a friction could make is none of this step's business, so factors
//! below fourfold need a named ratio and a fellow channel that is right. A log whose inputs are all wrong together
//! passes for another bench.

mod clock;
mod copies;
mod factors;
mod finding;
mod gain;
mod mend;
mod pairs;
mod reading;
mod simulated;
mod statistics;
mod stuck;

pub use finding::{Finding, Severity};

use crate::session::simulable;
use bench::log::LogError;
use bench::{Bench, Channel, MeasuredLog, Role};

/// Logs fit for comparison, and what was found in them.
pub(crate) struct Checked {
    pub(crate) logs: Vec<MeasuredLog>,
    pub(crate) held_out: Vec<MeasuredLog>,
    pub(crate) findings: Vec<Finding>,
}

/// Checks logs that were read as found. The gravest findings come first.
pub(crate) fn check(
    bench: &Bench,
    logs: &[MeasuredLog],
    held_out: &[MeasuredLog],
) -> Result<Checked, LogError> {
    let mut findings = Vec::new();
    let logs = copies::distinct(logs, &[], &mut findings);
    let held_out = copies::distinct(held_out, &logs, &mut findings);
    let mut all = |logs: Vec<&MeasuredLog>| -> Result<Vec<MeasuredLog>, LogError> {
        logs.into_iter().map(|log| one(bench, log, &mut findings)).collect()
    };
    let (logs, held_out) = (all(logs)?, all(held_out)?);
    findings.sort_by_key(|f| f.severity);
    Ok(Checked { logs, held_out, findings })
}

fn one(bench: &Bench, log: &MeasuredLog, findings: &mut Vec<Finding>) -> Result<MeasuredLog, LogError> {
    let (had, first) = (simulable(bench, log), findings.len());
    let mut log = log.clone();
    clock::order(&mut log, findings)?;
    reading::missing(&mut log, findings)?;
    clock::unit(bench, &mut log, findings);
    clock::rate(&log, findings);
    reading::steps(bench, &log, findings);
    let interval_s = clock::interval_s(&log);
    let keep = reading::outliers(bench, &log, Role::Input, |_| None, findings);
    keep_rows(&mut log, &keep);
    pairs::inputs(bench, &mut log, interval_s, findings);
    if let Some(simulated) = simulated::load(bench, &mut log, findings) {
        simulated::swapped(bench, &mut log, &simulated, findings);
        simulated::units(bench, &mut log, &simulated, findings);
        gain::check(bench, &mut log, &simulated, findings);
        let moving = stuck::check(bench, &mut log, &simulated, findings);
        let inlying = reading::outliers(bench, &log, Role::Output, |c| simulated.of(c), findings);
        let keep: Vec<bool> = moving.into_iter().zip(inlying).map(|(a, b)| a && b).collect();
        keep_rows(&mut log, &keep);
    }
    if !had.is_empty() && simulable(bench, &log).is_empty() {
        let is_gone =
            |f: &&Finding| had.iter().any(|c| c.name() == f.channel) && f.severity == Severity::Wrong;
        let words = findings.iter().skip(first).filter(is_gone);
        let words: Vec<String> = words.map(|f| format!("{}: {}, {}", f.channel, f.found, f.cause)).collect();
        return Err(LogError::Content {
            file: log.source,
            found: format!("no output that can be right ({})", words.join("; ")),
            expected: "at least one measured output that can be compared with the simulation".into(),
        });
    }
    pairs::outputs(&log, interval_s, findings);
    Ok(log)
}

/// Leaves out rows.
fn keep_rows(log: &mut MeasuredLog, keep: &[bool]) {
    if keep.iter().all(|k| *k) {
        return;
    }
    let cut = |values: &mut Vec<f64>| {
        let mut keep = keep.iter();
        values.retain(|_| keep.next() == Some(&true));
    };
    cut(&mut log.time_s);
    log.channels.values_mut().for_each(cut);
}

/// Multiplies a channel.
fn multiply(log: &mut MeasuredLog, channel: Channel, factor: f64) {
    for value in log.channels.get_mut(&channel).into_iter().flatten() {
        *value *= factor;
    }
}

#[cfg(test)]
mod honest;
#[cfg(test)]
mod readings_tests;
#[cfg(test)]
mod tests;
