//! Measured logs: one row a sample, one column a channel. CSV, Parquet and MAT-files, one file a format; the format is told
//! by a file's content when it is read and by its name's ending when it is written.

mod error;
mod mat;
mod mat_write;
mod parquet;
mod source;
mod text;

pub use error::LogError;

use crate::atomic;
use crate::channel::{Channel, Role};
use crate::log_format::{Column, ColumnId, LogFormat, TIME};
use source::Source;
use std::collections::BTreeMap;
use std::path::Path;

/// Rows a log may have: bounds memory on hostile input.
const MOST_ROWS: usize = 20_000_000;

/// A log in SI.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeasuredLog {
    /// Where it came from, for messages.
    pub source: String,
    /// Time of each sample in s, strictly ascending unless the log was read as found.
    pub time_s: Vec<f64>,
    /// Signals by channel, each as long as the time; finite unless the log was read as found.
    pub channels: BTreeMap<Channel, Vec<f64>>,
}

impl MeasuredLog {
    /// Reads a log through a format. Columns that are no channel are left out; a missing value and a time that does not
    /// ascend are refused.
    pub fn read(path: &Path, format: &LogFormat) -> Result<Self, LogError> {
        Self::open(path, format, true)
    }

    /// Reads a log with all that may be wrong in it, for those who check it themselves: missing values are NaN, and times
    /// are as they stand.
    pub fn read_as_found(path: &Path, format: &LogFormat) -> Result<Self, LogError> {
        Self::open(path, format, false)
    }

    fn open(path: &Path, format: &LogFormat, strict: bool) -> Result<Self, LogError> {
        let file = path.display().to_string();
        let bytes = std::fs::read(path).map_err(|source| LogError::Io { file: file.clone(), source })?;
        Self::of_bytes(&file, bytes, format, strict)
    }

    /// Parses a text log as [`MeasuredLog::read`] does; `file` names it in messages.
    pub fn parse(file: &str, text: &str, format: &LogFormat) -> Result<Self, LogError> {
        Self::of_bytes(file, text.as_bytes().to_vec(), format, true)
    }

    fn of_bytes(file: &str, bytes: Vec<u8>, format: &LogFormat, strict: bool) -> Result<Self, LogError> {
        let content = |found: String, expected: &str| LogError::content(file, found, expected);
        let source = Source::open(file, bytes, &format.text)?;
        let own_time = Column { from: ColumnId::Name(TIME.into()), scale: 1.0, offset: 0.0 };
        let time_column = format.columns.get(TIME).unwrap_or(&own_time);
        let time = source.locate(file, time_column)?;
        let mut wanted: Vec<(Channel, usize, &Column)> = Vec::new();
        for (name, column) in &format.columns {
            if let Some(channel) = Channel::from_name(name) {
                wanted.push((channel, source.locate(file, column)?, column));
            }
        }
        let plain = Column { from: ColumnId::Index(0), scale: 1.0, offset: 0.0 };
        for (index, name) in source.names().iter().enumerate() {
            if let Some(channel) = Channel::from_name(name)
                && !format.columns.contains_key(channel.name())
            {
                if wanted.iter().any(|(known, ..)| *known == channel) {
                    return Err(content(format!("the column `{name}` twice"), "every channel once"));
                }
                wanted.push((channel, index, &plain));
            }
        }
        if wanted.is_empty() {
            let names = Channel::ALL.iter().map(|c| c.name()).collect::<Vec<_>>().join(", ");
            return Err(content(
                format!("no known channel among the columns `{}`", source.names().join("`, `")),
                &format!("some of {names}, or a [columns] table that maps foreign names"),
            ));
        }
        let values = |name: &str, index: usize, column: &Column| -> Result<Vec<f64>, LogError> {
            let mut values = source.values(file, index, name, strict)?;
            if values.len() > MOST_ROWS {
                return Err(content(format!("more than {MOST_ROWS} rows"), "a log cut into sessions"));
            }
            for value in &mut values {
                *value = column.scale * *value + column.offset;
            }
            // Where every value counts, the first that is none is named by its place.
            match values.iter().position(|v| !v.is_finite()) {
                Some(row) if strict => Err(LogError::Field {
                    file: file.into(),
                    place: source.place(row),
                    column: name.into(),
                    found: values.get(row).map_or_else(String::new, f64::to_string),
                    expected: "a finite number",
                }),
                _ => Ok(values),
            }
        };
        let time_s = values(TIME, time, time_column)?;
        if let Some(row) = time_s.windows(2).position(|w| matches!(w, [a, b] if b <= a)).filter(|_| strict) {
            let at = |row: usize| time_s.get(row).copied().unwrap_or_default();
            return Err(LogError::Field {
                file: file.into(),
                place: source.place(row + 1),
                column: TIME.into(),
                found: format!("{} after {}", at(row + 1), at(row)),
                expected: "times that ascend strictly",
            });
        }
        let mut log = Self { source: file.into(), ..Self::default() };
        for (channel, index, column) in wanted {
            let values = values(channel.name(), index, column)?;
            if values.len() != time_s.len() {
                let name = source.names().get(index).map_or_else(|| index.to_string(), Clone::clone);
                return Err(content(
                    format!("`{name}` for {channel} has {} values", values.len()),
                    &format!("{}, as many as times", time_s.len()),
                ));
            }
            log.channels.insert(channel, values);
        }
        if time_s.len() < 2 {
            return Err(content(format!("{} data rows", time_s.len()), "at least 2"));
        }
        log.time_s = time_s;
        Ok(log)
    }

    /// The log as CSV text, channels in their order, shortest numbers that read back exactly.
    pub fn to_csv(&self) -> String {
        let mut text = String::from("t_s");
        for channel in self.channels.keys() {
            text.push(',');
            text.push_str(channel.name());
        }
        text.push('\n');
        for (i, t) in self.time_s.iter().enumerate() {
            text.push_str(&t.to_string());
            for values in self.channels.values() {
                text.push(',');
                if let Some(value) = values.get(i) {
                    text.push_str(&format!("{value:e}"));
                }
            }
            text.push('\n');
        }
        text
    }

    /// Writes the log, whole or not at all: Parquet to `.parquet`, a MAT-file to `.mat`, else CSV.
    pub fn write(&self, path: &Path) -> Result<(), LogError> {
        let file = path.display().to_string();
        let ending = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        let bytes = match ending.as_deref() {
            Some("parquet") => parquet::bytes(self)
                .map_err(|e| LogError::Io { file: file.clone(), source: std::io::Error::other(e) })?,
            Some("mat") => mat_write::bytes(&file, self)?,
            _ => self.to_csv().into_bytes(),
        };
        atomic::write(path, &bytes).map_err(|source| LogError::Io { file, source })
    }

    /// A channel, or a refusal that names it.
    pub fn need(&self, channel: Channel) -> Result<&[f64], LogError> {
        self.channels.get(&channel).map(Vec::as_slice).ok_or_else(|| self.missing(channel))
    }

    /// The refusal of a log that lacks a channel.
    pub fn missing(&self, channel: Channel) -> LogError {
        LogError::content(
            &self.source,
            format!("no column `{channel}`"),
            format!("the input `{channel}` of this plant"),
        )
    }

    /// The output channels of the log.
    pub fn outputs(&self) -> impl Iterator<Item = (Channel, &[f64])> {
        self.channels.iter().filter(|(c, _)| c.role() == Role::Output).map(|(c, v)| (*c, v.as_slice()))
    }
}

#[cfg(test)]
mod binary_tests;
#[cfg(test)]
mod tests;
