//! All columns of a log that contain numbers, without a description.

use super::files::{self, MAX_ROWS, MAX_VALUES, NO_THOUSANDS, Written};
use super::{LogError, TextFormat};
use crate::atomic;
use std::collections::BTreeSet;
use std::path::Path;

/// Maximum number of reasons in the error of a log without columns of numbers.
const MAX_REASONS: usize = 3;
/// Purpose of a column in the messages of the readers.
const WANTED: &str = "a column";

/// Column of a log.
#[derive(Clone, Debug, PartialEq)]
pub struct RawColumn {
    /// Index from 0.
    pub index: usize,
    /// Name; empty in a text without a header.
    pub name: String,
    /// Unit; empty if the file has none.
    pub unit: String,
    /// Group, such as a group of channels or a sheet; empty without groups.
    pub group: String,
    /// Index of the column with its times, its own for times; `None` if the file does not state it.
    pub time: Option<usize>,
    /// Readings, NaN where missing.
    pub values: Vec<f64>,
}

impl RawColumn {
    /// Name, `column_0` and so on without one.
    pub fn label(&self) -> String {
        if self.name.is_empty() { format!("column_{}", self.index) } else { self.name.clone() }
    }

    /// Returns whether another column has the same values, missing ones included.
    pub fn has_values_of(&self, other: &Self) -> bool {
        let is_same = |(a, b): (&f64, &f64)| a == b || a.is_nan() && b.is_nan();
        let pairs = || self.values.iter().zip(&other.values);
        self.index == other.index || self.values.len() == other.values.len() && pairs().all(is_same)
    }

    /// Smallest and largest reading; `None` without readings.
    pub fn range(&self) -> Option<(f64, f64)> {
        let readings = || self.values.iter().copied().filter(|value| value.is_finite());
        Some((readings().reduce(f64::min)?, readings().reduce(f64::max)?))
    }
}

/// Content of a log that is no column of numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct OtherContent {
    /// Name; the index from 0 in a text without a header.
    pub name: String,
    /// Reason why it is no column of numbers.
    pub reason: String,
}

/// Columns of a log that contain numbers. They may have different lengths.
#[derive(Clone, Debug, PartialEq)]
pub struct RawLog {
    /// Origin of the log, for messages.
    pub source: String,
    /// Format of the file in words.
    pub file_format: &'static str,
    /// Text format as detected; the default for a binary file, whose columns have names.
    pub format: TextFormat,
    /// Columns with numbers, in the order of the file.
    pub columns: Vec<RawColumn>,
    /// Other content, in the order of the file.
    pub others: Vec<OtherContent>,
}

impl RawLog {
    /// Reads a log and detects its format.
    pub fn read(path: &Path) -> Result<Self, LogError> {
        let file = path.display().to_string();
        Self::from_bytes(&file, files::read(path)?)
    }

    /// Reads the content of a file, which messages call `file`.
    pub fn from_bytes(file: &str, bytes: Vec<u8>) -> Result<Self, LogError> {
        let source = files::open(file, bytes, None)?;
        let Some(format) = source.detected() else {
            return Err(LogError::content(
                file,
                "no columns of numbers with one separator",
                "a number in every column of every line after the header, separated by commas, semicolons, \
                 tabs or blanks",
            ));
        };
        let (mut columns, mut others, mut held) = (Vec::new(), Vec::new(), 0);
        for index in 0..source.width() {
            let name = source.names().get(index).cloned().unwrap_or_default();
            let reason = match source.values(file, index, WANTED, false) {
                Err(error @ LogError::Field { expected: NO_THOUSANDS, .. }) => return Err(error),
                Ok(values) if values.len() > MAX_ROWS => {
                    let found = format!("column `{name}` with more than {MAX_ROWS} rows");
                    return Err(LogError::content(file, found, "a log divided into several"));
                }
                Ok(values) if values.iter().any(|value| value.is_finite()) => {
                    held += values.len();
                    if held > MAX_VALUES {
                        let found = format!("more than {MAX_VALUES} numbers in all columns");
                        return Err(LogError::content(file, found, "a log divided into several"));
                    }
                    let unit = source.unit(index).to_owned();
                    let group = source.group(index).to_owned();
                    let time = source.time_of(index);
                    columns.push(RawColumn { index, name, unit, group, time, values });
                    continue;
                }
                Ok(_) => "no readings".into(),
                Err(error) => error.reason(WANTED),
            };
            let name = if name.is_empty() { index.to_string() } else { name };
            others.push(OtherContent { name, reason });
        }
        if columns.is_empty() && !others.is_empty() {
            let reason = |other: &OtherContent| format!("`{}`: {}", other.name, other.reason);
            let reasons: Vec<String> = others.iter().take(MAX_REASONS).map(reason).collect();
            let found = format!("no columns of numbers ({})", reasons.join("; "));
            return Err(LogError::content(file, found, "columns of numbers"));
        }
        if columns.iter().all(|column| column.values.len() < 2) {
            return Err(LogError::content(file, "fewer than 2 rows of numbers", "at least 2"));
        }
        let file_format = source.format();
        Ok(Self { source: file.into(), file_format, format, columns, others })
    }

    /// Writes columns atomically, with names and units: Parquet to `.parquet`, a MAT-file to
    /// `.mat`, else CSV. Messages call their origin `source`.
    ///
    /// # Errors
    ///
    /// The columns have different lengths, or the file cannot be written.
    pub fn write(source: &str, path: &Path, columns: &[&RawColumn]) -> Result<(), LogError> {
        let file = path.display().to_string();
        let lengths: BTreeSet<usize> = columns.iter().map(|column| column.values.len()).collect();
        if lengths.len() > 1 {
            let lengths: Vec<String> = lengths.iter().map(usize::to_string).collect();
            let found = format!("columns of {} rows", lengths.join(" and "));
            return Err(LogError::content(source, found, "columns of one length"));
        }
        let names: Vec<String> = columns.iter().map(|column| column.label()).collect();
        let written: Vec<Written<'_>> = columns
            .iter()
            .zip(&names)
            .map(|(column, name)| Written { name, unit: &column.unit, values: &column.values })
            .collect();
        let bytes = files::bytes(&file, &written)?;
        atomic::write(path, &bytes).map_err(|source| LogError::Io { file, source })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_foreign_text_is_read_with_its_own_separator_and_decimal_comma() {
        let text = "Zeit [ms];Weg [mm];Name\n0;1,5;a\n10;;b\n20;2,5;c\n";
        let log = RawLog::from_bytes("a.csv", text.as_bytes().to_vec()).unwrap_err().to_string();
        assert!(log.starts_with("a.csv: found no columns of numbers") || log.contains("no columns"), "{log}");
        let log = RawLog::from_bytes(
            "a.csv",
            text.replace(";Name", "").replace(";a", "").replace(";b", "").replace(";c", "").into_bytes(),
        )
        .unwrap();
        assert!(log.format.decimal_comma && log.format.header);
        assert_eq!(log.columns[1].name, "Weg [mm]");
        assert_eq!(log.columns[1].range(), Some((1.5, 2.5)));
        assert!(log.columns[1].values[1].is_nan());
        let thousands = b"t;x\n0;1.234,5\n1;2.345,5\n".to_vec();
        let refused = RawLog::from_bytes("a.csv", thousands).unwrap_err().to_string();
        let expected = "line 2, a column: found `1.234,5`; expected a number without separators of thousands";
        assert_eq!(refused, format!("a.csv: {expected}"));
    }
}
