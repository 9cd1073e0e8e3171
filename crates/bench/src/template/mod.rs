//! Template of a bench description for a log: every required field with its meaning, unit and
//! range, filled in as far as the log's header and amplitudes determine it.
//!
//! A value that the user has to fill in is [`FILL_IN`](crate::reading::FILL_IN). A description with
//! such a value is refused with the list of all of them.

mod columns;
mod names;
mod render;
mod signals;
mod values;

pub use signals::TemplatePlant;

use crate::description::AxisKind;
use crate::log::{LogError, RawColumn, RawLog, TIME};
use crate::signals::Channel;
use columns::{candidates, chambers, choose, motion_kind};
use names::{MotionKind, Quantity};
use schemars::JsonSchema;
use serde::Serialize;
use signals::{Signal, signals};

/// Column of a log as a template uses it.
#[derive(Clone, Debug, JsonSchema, Serialize)]
pub struct TemplateColumn {
    /// Index from 0.
    pub index: usize,
    /// Name; empty in a text without a header.
    pub name: String,
    /// Smallest reading.
    pub min: f64,
    /// Largest reading.
    pub max: f64,
    /// Signal that the column is taken for.
    pub signal: Option<&'static str>,
}

/// Template of a description.
#[derive(Clone, Debug, JsonSchema, Serialize)]
pub struct Template {
    /// Plant.
    pub plant: &'static str,
    /// Columns of the log with numbers.
    pub columns: Vec<TemplateColumn>,
    /// Dotted names of the values to fill in.
    pub to_fill_in: Vec<String>,
    /// The description as TOML with comments.
    pub toml: String,
}

/// Writes the template for a log. Without `plant` the header decides.
pub fn template(log: &RawLog, plant: Option<TemplatePlant>) -> Result<Template, LogError> {
    let candidates = of_one_time(log);
    let is_of_bench = |name: &str| {
        let is_input = name == Channel::DriveDisplacement.name() || name == Channel::DriveVelocity.name();
        is_input || name == Channel::ShaftAngle.name() || name == Channel::JournalY.name()
    };
    let plant = plant.unwrap_or_else(|| {
        if candidates.iter().any(|c| c.meaning.own.is_some_and(is_of_bench)) {
            return TemplatePlant::Transmission;
        }
        TemplatePlant::Axis(match motion_kind(&candidates) {
            MotionKind::Rotary => AxisKind::Rotary,
            MotionKind::Linear => AxisKind::Linear,
        })
    });
    let mut signals = signals(&candidates, plant);
    // Two pressures of an axis without a force are those of its cylinder, and no load.
    let chambers = chambers(&candidates).filter(|_| {
        let is_effort = |s: &&Signal<'_>| s.name == Channel::DriveForce.name();
        matches!(plant, TemplatePlant::Axis(AxisKind::Linear))
            && signals.iter().find(is_effort).is_some_and(|effort| effort.chosen.is_none())
    });
    if chambers.is_some() {
        let loads = signals.iter_mut().filter(|s| s.name == Channel::LoadForce.name());
        loads.for_each(|load| load.chosen = None);
    }
    let values = values::values(&signals, plant);
    let (toml, to_fill_in) = render::render(log, plant, (&signals, chambers), &values)?;
    let column = |column: &RawColumn| {
        let taken = |s: &&Signal<'_>| s.chosen.as_ref().is_some_and(|c| c.column.index == column.index);
        let (min, max) = column.range().unwrap_or_default();
        let signal = signals.iter().find(taken).map(|signal| signal.name);
        TemplateColumn { index: column.index, name: column.name.clone(), min, max, signal }
    };
    Ok(Template { plant: plant.plant(), columns: log.columns.iter().map(column).collect(), to_fill_in, toml })
}

/// Column of the times of a log with its factor to s: the one that the file states for the longest
/// columns, rather one in a unit of time, else as far as the name or the intervals indicate it.
pub fn time_column(log: &RawLog) -> Option<(&RawColumn, Option<f64>)> {
    let rows = log.columns.iter().map(|column| column.values.len()).max();
    let longest = log.columns.iter().filter(|column| Some(column.values.len()) == rows);
    let times = longest.filter_map(|column| column.time.filter(|time| *time != column.index));
    let mut known = times.filter_map(|time| stated(log, time));
    // The axis of a spectrum has no unit of time.
    if let Some(first) = known.next() {
        return Some(if first.1.is_some() {
            first
        } else {
            known.find(|time| time.1.is_some()).unwrap_or(first)
        });
    }
    let chosen = choose(&candidates(log), TIME, Some(Quantity::Time), None)?;
    Some((chosen.column, chosen.scale))
}

/// Column of times that the file states, with its factor to s.
fn stated(log: &RawLog, time: usize) -> Option<(&RawColumn, Option<f64>)> {
    let column = log.columns.iter().find(|column| column.index == time)?;
    Some((column, columns::candidate(column).meaning.scale))
}

/// Column of the times of another column with its factor to s: the one that the file states, else
/// one of the same group with as many rows.
pub fn time_of<'a>(log: &'a RawLog, column: &RawColumn) -> Option<(&'a RawColumn, Option<f64>)> {
    if let Some(time) = column.time {
        return stated(log, time);
    }
    // Times that the file states are those of the columns for which it states them.
    let is_beside =
        |c: &&RawColumn| c.time.is_none() && c.group == column.group && c.values.len() == column.values.len();
    let beside: Vec<columns::Candidate<'_>> =
        log.columns.iter().filter(is_beside).map(columns::candidate).collect();
    let chosen = choose(&beside, TIME, Some(Quantity::Time), None)?;
    Some((chosen.column, chosen.scale))
}

/// Returns whether a column has the times of a column of times, as far as the file states it: a
/// column without a time has not those that the file states for others.
pub fn has_time(log: &RawLog, column: &RawColumn, time: &RawColumn) -> bool {
    let is_stated = time.time == Some(time.index);
    if column.time.is_none() && column.group == time.group && !is_stated {
        return true;
    }
    match time_of(log, column) {
        Some((own, _)) => own.has_values_of(time),
        None => !is_stated,
    }
}

/// Columns with the times of the log, which may be in one description.
fn of_one_time(log: &RawLog) -> Vec<columns::Candidate<'_>> {
    let mut candidates = candidates(log);
    if let Some((time, _)) = time_column(log) {
        candidates.retain(|c| match c.meaning.quantity {
            _ if c.column.index == time.index => true,
            Some(Quantity::Time) => false,
            _ => has_time(log, c.column, time),
        });
    }
    candidates
}

#[cfg(test)]
mod tests;
