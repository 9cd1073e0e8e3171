//! Measured logs: one row per sample, one column per channel. The format is detected from a file's
//! content for reading and from its extension for writing.

mod error;
mod expression;
mod files;
mod format;
mod measured;
mod raw;
mod reader;
mod resample;

pub use error::LogError;
pub use expression::{Expression, SyntaxError};
pub(crate) use format::columns;
pub use format::{Column, ColumnId, Columns, LogFormat, Separator, TIME, TextFormat, is_signal};
pub use measured::MeasuredLog;
pub use raw::{OtherContent, RawColumn, RawLog};
pub use resample::{Timed, resample};

use crate::atomic;
use files::Written;
use format::TIME_UNIT;
use std::path::Path;

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
}

#[cfg(test)]
mod binary_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod text_tests;
