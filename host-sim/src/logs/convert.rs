//! Conversion of a log to CSV, Parquet or a MAT-file: as it was found, or in SI with the names of
//! the signals of a description.

use crate::cli::error::CliError;
use bench::Bench;
use bench::log::{MeasuredLog, RawColumn, RawLog, Timed, resample};
use bench::template::{has_time, time_column, time_of};
use schemars::JsonSchema;
use serde::Serialize;
use std::path::Path;

/// Endings of the files that can be written.
const ENDINGS: [&str; 3] = ["csv", "parquet", "mat"];

/// Converted log.
#[derive(Clone, Debug, JsonSchema, Serialize)]
pub(crate) struct Converted {
    /// File that was written.
    pub(crate) log: String,
    /// Columns that were written.
    pub(crate) columns: Vec<String>,
    /// Rows that were written.
    pub(crate) rows: usize,
    /// Columns of numbers that were left out, with the reason.
    pub(crate) left_out: Vec<String>,
}

/// Checks the file to write before the work.
///
/// # Errors
///
/// Its ending is not known, or it is the log itself.
pub(crate) fn check(log: &Path, out: &Path) -> Result<(), CliError> {
    let ending = out.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    if !ending.as_ref().is_some_and(|ending| ENDINGS.contains(&ending.as_str())) {
        let found = out.display();
        return Err(CliError::Input(format!("OUT: found {found}; expected a file .csv, .parquet or .mat")));
    }
    let same = out.canonicalize().is_ok_and(|out| log.canonicalize().is_ok_and(|log| log == out));
    if same {
        return Err(CliError::Input(format!("OUT: found {}, the log; expected another file", out.display())));
    }
    Ok(())
}

/// Converts a log to the signals of a description, in SI.
///
/// # Errors
///
/// The log does not have the columns, or the file cannot be written.
pub(crate) fn described(log: &Path, bench: &Bench, out: &Path) -> Result<Converted, CliError> {
    let measured = MeasuredLog::read_as_found(log, &bench.log_format())?;
    measured.write(out)?;
    let names = measured.channels.keys().map(|channel| channel.name().to_owned());
    Ok(Converted {
        log: out.display().to_string(),
        columns: std::iter::once(bench::log::TIME.to_owned()).chain(names).collect(),
        rows: measured.time_s.len(),
        left_out: Vec::new(),
    })
}

/// Converts the columns of a log as they were found: those with the given names, else all that have
/// as many rows as the time.
///
/// # Errors
///
/// A name is no column, the columns have different lengths or times, or the file cannot be written.
pub(crate) fn as_found(log: &RawLog, names: &[String], out: &Path) -> Result<Converted, CliError> {
    let (chosen, left_out) = match names {
        [] => of_time(log),
        names => (named(log, names)?, Vec::new()),
    };
    if !names.is_empty() {
        check_times(log, &chosen)?;
    }
    RawLog::write(&log.source, out, &chosen)?;
    Ok(Converted {
        log: out.display().to_string(),
        columns: chosen.iter().map(|column| column.label()).collect(),
        rows: chosen.first().map_or(0, |column| column.values.len()),
        left_out,
    })
}

/// Converts columns to one rate in Hz: those with the given names, else all that have a time.
///
/// # Errors
///
/// A name is no column or has no time in seconds, the times do not ascend or do not overlap, or the
/// file cannot be written.
pub(crate) fn resampled(
    log: &RawLog,
    names: &[String],
    rate_hz: f64,
    out: &Path,
) -> Result<Converted, CliError> {
    let chosen: Vec<&RawColumn> =
        if names.is_empty() { log.columns.iter().collect() } else { named(log, names)? };
    let (mut timed, mut left_out) = (Vec::new(), Vec::new());
    for column in chosen {
        match time_of(log, column) {
            Some((time, _)) if time.index == column.index => {}
            Some((time, Some(scale))) if column.values.iter().filter(|v| v.is_finite()).count() > 1 => {
                timed.push(Timed { column, times: &time.values, scale });
            }
            Some((_, Some(_))) => left_out.push(format!("{} (fewer than 2 readings)", column.name)),
            _ => left_out.push(format!("{} (no time in seconds)", column.name)),
        }
    }
    if !names.is_empty() && !left_out.is_empty() || timed.is_empty() {
        let found = if left_out.is_empty() { "only times".to_owned() } else { left_out.join(", ") };
        return Err(CliError::Input(format!(
            "--rate: found {found}; expected columns with two readings at least, beside a column of times of \
             the same group and length with a unit"
        )));
    }
    let columns = resample(&log.source, &timed, rate_hz)?;
    RawLog::write(&log.source, out, &columns.iter().collect::<Vec<_>>())?;
    Ok(Converted {
        log: out.display().to_string(),
        columns: columns.iter().map(|column| column.label()).collect(),
        rows: columns.first().map_or(0, |column| column.values.len()),
        left_out,
    })
}

/// Columns with the times of the log, else as many rows as the longest one, and the others.
fn of_time(log: &RawLog) -> (Vec<&RawColumn>, Vec<String>) {
    let longest = log.columns.iter().map(|column| column.values.len()).max().unwrap_or(0);
    let time = time_column(log).map(|(column, _)| column);
    let rows = time.map_or(longest, |column| column.values.len());
    let (mut chosen, mut left_out) = (Vec::new(), Vec::new());
    for column in &log.columns {
        if column.values.len() != rows {
            left_out.push(format!("{} ({} rows)", column.label(), column.values.len()));
        } else if time.is_some_and(|time| !has_time(log, column, time)) {
            let reason = match time_of(log, column) {
                Some((own, _)) if own.index != column.index => format!("times of {}", own.label()),
                Some(_) => "other times".into(),
                None => "no time".into(),
            };
            left_out.push(format!("{} ({reason})", column.label()));
        } else {
            chosen.push(column);
        }
    }
    (chosen, left_out)
}

/// Refuses columns with different times, each of which would be beside those of another.
fn check_times(log: &RawLog, columns: &[&RawColumn]) -> Result<(), CliError> {
    let times = columns.iter().filter_map(|column| Some((column, time_of(log, column)?.0)));
    let mut times = times.filter(|(column, time)| column.index != time.index);
    let Some((first, of_first)) = times.next() else { return Ok(()) };
    match times.find(|(_, time)| !time.has_values_of(of_first)) {
        Some((other, of_other)) => Err(CliError::Input(format!(
            "--column: found `{}` with the times `{}` and `{}` with `{}`; expected columns with the \
             same times, or --rate to give them one time",
            first.name, of_first.name, other.name, of_other.name
        ))),
        None => Ok(()),
    }
}

fn named<'a>(log: &'a RawLog, names: &[String]) -> Result<Vec<&'a RawColumn>, CliError> {
    let find = |name: &String| log.columns.iter().find(|column| column.label() == *name);
    let missing: Vec<&str> = names.iter().filter(|n| find(n).is_none()).map(String::as_str).collect();
    if !missing.is_empty() {
        let known: Vec<String> = log.columns.iter().map(RawColumn::label).collect();
        return Err(CliError::Input(format!(
            "--column: found `{}`; expected columns among `{}`",
            missing.join("`, `"),
            known.join("`, `")
        )));
    }
    Ok(names.iter().filter_map(find).collect())
}
