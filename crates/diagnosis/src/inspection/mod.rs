//! Inspection of logs before any fit: quality of the data, contradictions to the description, and
//! declared parameters that the recorded motion does not show.
//!
//! The information on the parameters is that of the described bench with the noise of the sensors.
//! Model errors add to that noise, so a parameter that is not shown here will not be shown by a
//! diagnosis either; the reverse is not certain.

pub(crate) mod channels;
pub(crate) mod motions;
pub(crate) mod parameters;
mod tuning;

use crate::check::{Finding, check};
use crate::data::logs::Data;
use crate::data::noise::NoiseModel;
use crate::data::split::{Split, cycle_count};
use crate::fit::simulation::simulate;
use crate::result::DiagnosisError;
use crate::verdict::identifiability::Identifiability;
use bench::{Bench, MeasuredLog};
use channels::{ChannelQuality, channel_qualities};
use motions::{MotionAdvice, advise};
use parameters::{DeclaredParameter, Information};
use schemars::JsonSchema;
use serde::Serialize;

/// Extent of one log.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct LogSummary {
    /// Name of the log.
    pub log: String,
    /// Rows that remain after the checks.
    pub rows: usize,
    /// Time from the first to the last row, s.
    pub duration_s: f64,
    /// Cycles of the motion; 0 if it does not repeat.
    pub cycles: f64,
}

/// Result of an inspection.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Inspection {
    /// Extent of each log.
    pub logs: Vec<LogSummary>,
    /// Findings about the logs, the most severe first.
    pub checks: Vec<Finding>,
    /// Range, resolution and noise of each channel.
    pub channels: Vec<ChannelQuality>,
    /// Parameters that the description declares uncertain.
    pub parameters: Vec<DeclaredParameter>,
    /// Declared parameters that the logs do not show or do not separate.
    pub not_determined: Vec<Identifiability>,
    /// Motions that would show or separate them.
    pub motions: Vec<MotionAdvice>,
}

/// Inspects logs of one bench.
pub fn inspect(bench: &Bench, logs: &[MeasuredLog]) -> Result<Inspection, DiagnosisError> {
    if logs.is_empty() {
        return Err(DiagnosisError::NoLog);
    }
    let checked = check(bench, logs, &[])?;
    let mut data = Data::new(bench, &checked.logs, &[], Split::Halves)?;
    data.use_all();
    let simulation = simulate(&data, bench, None)?;
    let noise = NoiseModel::from_nominal_residual(bench, &data, &data.residual(&simulation.columns));
    let channels = channel_qualities(bench, &checked.logs, &noise);
    let extent = |(log, own): (&crate::data::logs::Log, &MeasuredLog)| LogSummary {
        log: log.source.clone(),
        rows: own.time_s.len(),
        duration_s: own.time_s.last().zip(own.time_s.first()).map_or(0.0, |(last, first)| last - first),
        cycles: cycle_count(log.phase.as_deref()),
    };
    let information = Information::new(bench, data, noise)?;
    let not_determined = information.not_determined(None);
    let motions = advise(bench, &information, &not_determined);
    let data = &information.data;
    Ok(Inspection {
        logs: data.logs.iter().zip(&checked.logs).map(extent).collect(),
        checks: checked.findings,
        channels,
        parameters: information.parameters(),
        not_determined,
        motions,
    })
}

#[cfg(test)]
mod tests;
