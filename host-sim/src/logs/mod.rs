//! Content of a log file without a description, and its conversion to another format.

pub(crate) mod convert;
pub(crate) mod text;

use bench::log::{RawColumn, RawLog};
use bench::template::time_column;
use schemars::JsonSchema;
use serde::Serialize;

/// Content of a log file.
#[derive(Clone, Debug, JsonSchema, Serialize)]
pub(crate) struct LogInfo {
    /// File.
    log: String,
    /// Format in words.
    format: &'static str,
    /// Columns of numbers, in the order of the file.
    columns: Vec<ColumnInfo>,
    /// Time, if a column has its name or unit.
    time: Option<TimeInfo>,
    /// Content that is no column of numbers.
    others: Vec<OtherInfo>,
}

/// Column of numbers.
#[derive(Clone, Debug, JsonSchema, Serialize)]
pub(crate) struct ColumnInfo {
    /// Index from 0 among all columns of the file.
    index: usize,
    /// Name; empty in a text without a header.
    name: String,
    /// Unit; empty if the file has none.
    unit: String,
    /// Group whose columns share a time, such as a group of channels or a sheet; empty without
    /// groups.
    group: String,
    /// Number of rows.
    rows: usize,
    /// Rows without a reading.
    missing: usize,
    /// Smallest reading.
    min: f64,
    /// Largest reading.
    max: f64,
}

/// Column of times. In the unit of the column if that is not known, else in s.
#[derive(Clone, Debug, JsonSchema, Serialize)]
pub(crate) struct TimeInfo {
    /// Index of the column.
    index: usize,
    /// Name of the column.
    name: String,
    /// True if the unit is known or the times can only be seconds.
    in_seconds: bool,
    /// From the first to the last time.
    duration: f64,
    /// Median interval between two rows.
    interval: f64,
    /// Largest interval between two rows.
    largest_interval: f64,
    /// Rows whose time does not follow that of the row before.
    not_ascending: usize,
    /// First such row, from 1.
    first_not_ascending: Option<usize>,
}

/// Content that is no column of numbers.
#[derive(Clone, Debug, JsonSchema, Serialize)]
pub(crate) struct OtherInfo {
    /// Name.
    name: String,
    /// Reason why it is none.
    reason: String,
}

/// Describes a log.
pub(crate) fn info(log: &RawLog) -> LogInfo {
    let other = |other: &bench::log::OtherContent| OtherInfo {
        name: other.name.clone(),
        reason: other.reason.clone(),
    };
    LogInfo {
        log: log.source.clone(),
        format: log.file_format,
        columns: log.columns.iter().map(column).collect(),
        time: time_column(log).map(|(column, scale)| time(column, scale)),
        others: log.others.iter().map(other).collect(),
    }
}

fn column(column: &RawColumn) -> ColumnInfo {
    let (min, max) = column.range().unwrap_or_default();
    ColumnInfo {
        index: column.index,
        name: column.name.clone(),
        unit: column.unit.clone(),
        group: column.group.clone(),
        rows: column.values.len(),
        missing: column.values.iter().filter(|value| !value.is_finite()).count(),
        min,
        max,
    }
}

fn time(column: &RawColumn, scale: Option<f64>) -> TimeInfo {
    let factor = scale.unwrap_or(1.0);
    let steps = || column.values.windows(2).filter_map(|pair| Some(factor * (pair.get(1)? - pair.first()?)));
    let mut sorted: Vec<f64> = steps().filter(|step| step.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let mut finite = column.values.iter().filter(|value| value.is_finite());
    let first = finite.next();
    let ends = first.zip(finite.next_back().or(first));
    let falls = || steps().enumerate().filter(|(_, step)| step.is_nan() || *step <= 0.0);
    TimeInfo {
        index: column.index,
        name: column.name.clone(),
        in_seconds: scale.is_some(),
        duration: ends.map_or(0.0, |(first, last)| factor * (last - first)),
        interval: sorted.get(sorted.len() / 2).copied().unwrap_or_default(),
        largest_interval: sorted.last().copied().unwrap_or_default(),
        not_ascending: falls().count(),
        first_not_ascending: falls().next().map(|(row, _)| row + 2),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_of_a_log_has_its_rate_its_gaps_and_its_falls() {
        let text = "time [ms],x\n0,1\n10,2\n20,\n20,4\n50,5\n60,6\n";
        let log = RawLog::from_bytes("a.csv", text.as_bytes().to_vec()).unwrap();
        let found = info(&log);
        let time = found.time.unwrap();
        assert!((time.duration - 0.06).abs() < 1e-12 && (time.interval - 0.01).abs() < 1e-12, "{time:?}");
        assert!((time.largest_interval - 0.03).abs() < 1e-12, "{time:?}");
        assert_eq!((time.not_ascending, time.first_not_ascending), (1, Some(4)));
        let x = &found.columns[1];
        assert_eq!((x.rows, x.missing, x.min, x.max), (6, 1, 1.0, 6.0));
    }
}
