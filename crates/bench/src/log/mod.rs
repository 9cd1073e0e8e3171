//! Measured logs: one row per sample, one column per channel. The format is detected from a file's
//! content for reading and from its extension for writing.

mod error;
mod expression;
mod files;
mod format;
mod raw;
mod reader;
mod resample;

pub use error::LogError;
pub(crate) use format::columns;
pub use format::{Column, ColumnId, Columns, LogFormat, Separator, TIME, TextFormat, is_signal};

pub use raw::{OtherContent, RawColumn, RawLog};
pub use resample::{Timed, resample};

use crate::atomic;
use crate::signals::Channel;
use files::Written;
use format::TIME_UNIT;
use std::collections::BTreeMap;
use std::path::Path;

/// Log in SI units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeasuredLog {
    /// Origin of the log, for messages.
    pub source: String,
    /// Time of each sample in s; strictly ascending unless the log was read as found.
    pub time_s: Vec<f64>,
    /// Signals by channel, each as long as the time; finite unless the log was read as found.
    pub channels: BTreeMap<Channel, Vec<f64>>,
}

impl MeasuredLog {
    /// Reads a log in a format. Columns that are no channel are ignored. A missing value and a time
    /// that does not ascend are refused.
    pub fn read(path: &Path, format: &LogFormat) -> Result<Self, LogError> {
        Self::open(path, format, true)
    }

    /// Reads a log with all its defects, for callers that check it themselves: missing values are
    /// NaN, and times are unchanged.
    pub fn read_as_found(path: &Path, format: &LogFormat) -> Result<Self, LogError> {
        Self::open(path, format, false)
    }

    fn open(path: &Path, format: &LogFormat, strict: bool) -> Result<Self, LogError> {
        let file = path.display().to_string();
        reader::from_bytes(&file, files::read(path)?, format, strict)
    }

    /// Parses a text log as [`MeasuredLog::read`] does; `file` names it in messages.
    pub fn parse(file: &str, text: &str, format: &LogFormat) -> Result<Self, LogError> {
        reader::from_bytes(file, text.as_bytes().to_vec(), format, true)
    }

    /// Returns the log as CSV text: channels in their order, shortest numbers that read back
    /// exactly.
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

    /// Writes the log atomically: Parquet to `.parquet`, a MAT-file to `.mat`, else CSV.
    pub fn write(&self, path: &Path) -> Result<(), LogError> {
        let file = path.display().to_string();
        let mut columns = vec![Written { name: TIME, unit: TIME_UNIT, values: &self.time_s }];
        for (channel, values) in &self.channels {
            columns.push(Written { name: channel.name(), unit: channel.unit(), values });
        }
        let bytes = match files::is_text(path) {
            true => self.to_csv().into_bytes(),
            false => files::bytes(&file, &columns)?,
        };
        atomic::write(path, &bytes).map_err(|source| LogError::Io { file, source })
    }

    /// Returns a channel, or an error that names it.
    pub fn need(&self, channel: Channel) -> Result<&[f64], LogError> {
        self.channels.get(&channel).map(Vec::as_slice).ok_or_else(|| self.missing(channel))
    }

    /// Returns the error of a log that lacks a channel.
    pub fn missing(&self, channel: Channel) -> LogError {
        LogError::content(
            &self.source,
            format!("no column `{channel}`"),
            format!("the input `{channel}` of this plant"),
        )
    }

    /// Returns the error of a plant that has no log.
    pub(crate) fn plant_without_log(&self, plant: &str) -> LogError {
        LogError::content(&self.source, format!("plant `{plant}`, which has no log"), "a plant with a log")
    }
}

#[cfg(test)]
mod binary_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod text_tests;
