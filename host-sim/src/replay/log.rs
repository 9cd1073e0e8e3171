//! A measured log as input of a controller.
//!
//! The log's interval becomes the controller's sample period. Time 0 is the start of the log.

use crate::cli::error::CliError;
use crate::run::sensing;
use bench::{Channel, MeasuredLog};
use controller::estimator::SAMPLE_PERIOD_RANGE_US;
use link::SensorFrame;

/// Returns the median interval of a log in s, so that missing rows have no effect.
///
/// # Errors
///
/// It is outside the range of the controller.
pub fn period_s(log: &MeasuredLog) -> Result<f64, CliError> {
    let mut intervals: Vec<f64> =
        log.time_s.windows(2).filter_map(|w| Some(w.get(1)? - w.first()?)).collect();
    intervals.sort_by(f64::total_cmp);
    let period_s = intervals.get(intervals.len() / 2).copied().unwrap_or_default();
    // The controller counts integer microseconds.
    let period_us = (period_s * 1e6).round();
    if SAMPLE_PERIOD_RANGE_US.contains(&(period_us as i64)) {
        Ok(period_us * 1e-6)
    } else {
        Err(CliError::Input(format!(
            "{}: found {period_us:.0} us between samples; expected {} to {} us",
            log.source,
            SAMPLE_PERIOD_RANGE_US.start(),
            SAMPLE_PERIOD_RANGE_US.end()
        )))
    }
}

/// Returns the number of each row, counted in periods from the first. The controller notices a
/// missing row by them.
///
/// # Errors
///
/// Two rows belong to one period.
pub fn numbers(log: &MeasuredLog, period_s: f64) -> Result<Vec<u32>, CliError> {
    let start = log.time_s.first().copied().unwrap_or_default();
    // `as` saturates, and turns a time that is not a number into 0.
    let numbers: Vec<u32> = log.time_s.iter().map(|t| ((t - start) / period_s).round() as u32).collect();
    match numbers.array_windows().position(|[before, after]| after <= before) {
        None => Ok(numbers),
        Some(row) => Err(CliError::Input(format!(
            "{}: found rows {} and {} in one period of {:.0} us; expected one",
            log.source,
            row + 1,
            row + 2,
            1e6 * period_s
        ))),
    }
}

/// Returns the samples of a log.
///
/// # Errors
///
/// A channel is missing, or two rows belong to one period.
pub(crate) fn frames(log: &MeasuredLog, period_s: f64) -> Result<Vec<SensorFrame>, CliError> {
    let y = log.need(Channel::JournalY)?;
    let z = log.need(Channel::JournalZ)?;
    let angle = log.need(Channel::ShaftAngle)?;
    let load = log.need(Channel::LoadForce)?;
    let start = log.time_s.first().copied().unwrap_or_default();
    let rows = log.time_s.iter().zip(y).zip(z).zip(angle).zip(load).zip(numbers(log, period_s)?);
    Ok(rows
        .map(|(((((t, y), z), angle), load), number)| {
            sensing::frame(number, t - start, [*y, *z, *angle, *load])
        })
        .collect())
}
