//! A measured log as input of a controller.
//!
//! The log's interval becomes the controller's sample period. Time 0 is the start of the log.

use crate::cli::error::CliError;
use crate::run::sensing;
use bench::{Channel, MeasuredLog};
use link::SensorFrame;

/// Sample periods that the controller supports, s.
const PERIODS_S: std::ops::RangeInclusive<f64> = 50e-6..=1e-3;

/// Returns the median interval of a log in s, so that missing rows have no effect.
pub(crate) fn period_s(log: &MeasuredLog) -> Result<f64, CliError> {
    let mut intervals: Vec<f64> =
        log.time_s.windows(2).filter_map(|w| Some(w.get(1)? - w.first()?)).collect();
    intervals.sort_by(f64::total_cmp);
    let period_s = intervals.get(intervals.len() / 2).copied().unwrap_or_default();
    // The controller counts integer microseconds.
    let period_s = (period_s * 1e6).round() * 1e-6;
    if PERIODS_S.contains(&period_s) {
        Ok(period_s)
    } else {
        Err(CliError::Input(format!(
            "{}: found {:.0} us between samples; expected {:.0} to {:.0} us",
            log.source,
            period_s * 1e6,
            PERIODS_S.start() * 1e6,
            PERIODS_S.end() * 1e6
        )))
    }
}

pub(crate) fn frames(log: &MeasuredLog) -> Result<Vec<SensorFrame>, CliError> {
    let y = log.need(Channel::JournalY)?;
    let z = log.need(Channel::JournalZ)?;
    let angle = log.need(Channel::ShaftAngle)?;
    let load = log.need(Channel::LoadForce)?;
    let start = log.time_s.first().copied().unwrap_or_default();
    let rows = log.time_s.iter().zip(y).zip(z).zip(angle).zip(load).enumerate();
    Ok(rows
        .map(|(index, ((((t, y), z), angle), load))| {
            sensing::frame(index as u32, t - start, [*y, *z, *angle, *load])
        })
        .collect())
}
