//! Writing of a log: CSV text, Parquet or a MAT-file.

use super::{mat_write, parquet};
use crate::log::LogError;
use std::path::Path;

/// Column of a log that is written.
#[derive(Clone, Copy, Debug)]
pub(in crate::log) struct Written<'a> {
    pub(in crate::log) name: &'a str,
    /// Unit; empty for none.
    pub(in crate::log) unit: &'a str,
    /// Values, NaN where missing; all columns have as many.
    pub(in crate::log) values: &'a [f64],
}

/// Returns the content of a file: Parquet for `.parquet`, a MAT-file for `.mat`, else CSV.
pub(in crate::log) fn bytes(file: &str, columns: &[Written<'_>]) -> Result<Vec<u8>, LogError> {
    let failed = |error: &dyn std::fmt::Display| LogError::Io {
        file: file.to_owned(),
        source: std::io::Error::other(error.to_string()),
    };
    match Kind::of(Path::new(file)) {
        Kind::Parquet => parquet::bytes(columns).map_err(|e| failed(&e)),
        Kind::Mat => mat_write::bytes(file, columns),
        Kind::Text => csv(columns).map_err(|e| failed(&e)),
    }
}

/// Format of a file that is written.
#[derive(PartialEq)]
enum Kind {
    Text,
    Parquet,
    Mat,
}

impl Kind {
    fn of(path: &Path) -> Self {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
        match ending.as_deref() {
            Some("parquet") => Self::Parquet,
            Some("mat") => Self::Mat,
            _ => Self::Text,
        }
    }
}

/// Returns whether a file is written as text.
pub(in crate::log) fn is_text(path: &Path) -> bool {
    Kind::of(path) == Kind::Text
}

/// Returns CSV text: names, units if there are any, and shortest numbers that read back exactly.
fn csv(columns: &[Written<'_>]) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(columns.iter().map(|column| column.name))?;
    if columns.iter().any(|column| !column.unit.is_empty()) {
        writer.write_record(columns.iter().map(|column| column.unit))?;
    }
    let rows = columns.first().map_or(0, |column| column.values.len());
    for row in 0..rows {
        let value = |column: &Written<'_>| column.values.get(row).copied().filter(|value| !value.is_nan());
        writer.write_record(columns.iter().map(|c| value(c).map_or(String::new(), |v| format!("{v:?}"))))?;
    }
    writer.into_inner().map_err(|error| error.into_error().into())
}
