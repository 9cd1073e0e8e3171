//! Missing readings of a channel.

use super::finding::{Finding, Severity};
use super::rows::keep_rows;
use super::tuning;
use bench::log::LogError;
use bench::{Bench, MeasuredLog, Role};

/// Returns whether a number is a reading: neither missing nor a filler.
fn is_reading(value: f64) -> bool {
    value.abs() < tuning::MAX_READING
}

/// Removes rows with missing readings, and outputs of which many readings are missing; an error if
/// more than half of the rows would be removed.
pub(super) fn leave_out_missing(
    bench: &Bench,
    log: &mut MeasuredLog,
    findings: &mut Vec<Finding>,
) -> Result<(), LogError> {
    let rows = log.time_s.len();
    let mut keep = vec![true; rows];
    let (mut left_out, mut missing) = (Vec::new(), Vec::new());
    for (&channel, values) in &log.channels {
        let count = values.iter().filter(|v| !is_reading(**v)).count();
        if count == 0 {
            continue;
        }
        let is_left_out =
            count as f64 > tuning::MAX_MISSING_SHARE * rows as f64 && bench.role(channel) == Role::Output;
        let severity = if is_left_out { Severity::Wrong } else { Severity::Doubtful };
        let found = format!("{count} of {rows} readings are missing");
        let finding = Finding::new(severity, &log.source, channel.name(), "missing-values", found)
            .cause("lost by the logger, or a sensor that was not always connected")
            .evidence("missing", count as f64)
            .evidence("rows", rows as f64);
        if is_left_out {
            left_out.push(channel);
            findings.push(finding.applied("left out the channel"));
        } else {
            missing.push(format!("{channel} {count}"));
            keep.iter_mut().zip(values).for_each(|(k, v)| *k &= is_reading(*v));
            findings.push(finding.applied("left out these rows"));
        }
    }
    for channel in left_out {
        log.channels.remove(&channel);
    }
    let complete = keep.iter().filter(|k| **k).count();
    if 2 * complete < rows {
        return Err(LogError::Content {
            file: log.source.clone(),
            found: format!(
                "{complete} of {rows} rows with a reading of every channel (missing: {})",
                missing.join(", ")
            ),
            expected: "at least half: channels of one sample rate, or resampled to one".into(),
        });
    }
    keep_rows(log, &keep);
    Ok(())
}
