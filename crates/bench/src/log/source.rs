//! A log's file, split into columns by name. The format is detected from the first bytes, never
//! from the name alone.

use super::LogError;
use super::mat::Variables;
use super::parquet::Table;
use super::text::Text;
use crate::log::{Column, ColumnId, TextFormat};

/// First bytes of a Parquet file.
const PARQUET: &[u8] = b"PAR1";
/// First bytes of a MAT-file of version 5, 6 or 7.
const MAT_5: &[u8] = b"MATLAB 5.0 MAT-file";
const MAT_73: &[u8] = b"MATLAB 7.3 MAT-file";
/// First bytes of an HDF5 file.
const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";
/// Number of bytes that are searched for a zero, which no text has.
const SEARCHED_BYTES: usize = 4096;

/// File of a log, by format.
pub(super) enum Source {
    Text(Text),
    Parquet(Table),
    Mat(Variables),
}

impl Source {
    /// Opens a file and splits it into columns.
    pub(super) fn open(file: &str, bytes: Vec<u8>, format: &TextFormat) -> Result<Self, LogError> {
        if bytes.starts_with(PARQUET) {
            return Table::open(file, bytes).map(Self::Parquet);
        }
        if bytes.starts_with(MAT_73) || bytes.starts_with(HDF5) {
            return Err(LogError::content(
                file,
                "a MAT-file of version 7.3, which is HDF5",
                "version 5 to 7: in MATLAB, save(\"log.mat\", \"-v7\"); or CSV, or Parquet",
            ));
        }
        // Other writers begin with their own text; version and byte order follow at its end.
        let marked = matches!(bytes.get(124..128), Some([0, 1, b'I', b'M'] | [1, 0, b'M', b'I']));
        if marked || bytes.starts_with(MAT_5) {
            return Variables::open(file, &bytes).map(Self::Mat);
        }
        if bytes.iter().take(SEARCHED_BYTES).any(|&b| b == 0) {
            return Err(LogError::content(
                file,
                "an unknown binary file",
                "CSV text in UTF-8, Parquet, or a MAT-file of version 5 to 7",
            ));
        }
        Text::open(file, &String::from_utf8_lossy(&bytes), format).map(Self::Text)
    }

    /// Returns whether the content of a file is read as text.
    pub(super) fn is_text(bytes: &[u8]) -> bool {
        let is_binary = [PARQUET, MAT_5, MAT_73, HDF5].iter().any(|start| bytes.starts_with(start));
        !is_binary && !bytes.iter().take(SEARCHED_BYTES).any(|&b| b == 0)
    }

    /// Clause about the text format that the file seems to have, if another one is described.
    pub(super) fn hint(&self) -> String {
        match self {
            Self::Text(Text { other_format: Some(format), .. }) => {
                format!("; the file looks like `[log]` with {}", format.lines().join(", "))
            }
            _ => String::new(),
        }
    }

    /// Number of columns of a text without a header; else 0.
    pub(super) fn width(&self) -> usize {
        if let Self::Text(text) = self { text.width() } else { 0 }
    }

    /// Names of the columns; empty for a text without a header.
    pub(super) fn names(&self) -> &[String] {
        match self {
            Self::Text(text) => &text.header,
            Self::Parquet(table) => &table.names,
            Self::Mat(variables) => &variables.names,
        }
    }

    /// Index of a column.
    pub(super) fn locate(&self, file: &str, column: &Column) -> Result<usize, LogError> {
        match &column.from {
            ColumnId::Index(index) => Ok(*index),
            ColumnId::Name(name) => self.names().iter().position(|n| n == name).ok_or_else(|| {
                LogError::content(
                    file,
                    format!("no column `{name}` among `{}`", self.names().join("`, `")),
                    match self {
                        Self::Text(_) => format!("a header with `{name}`{}", self.hint()),
                        Self::Parquet(_) => format!("a column `{name}`"),
                        Self::Mat(_) => {
                            format!(
                                "a variable `{name}` (a field of a struct is `data.{name}`, \
                                 a column `{name}(:,1)`)"
                            )
                        }
                    },
                )
            }),
        }
    }

    /// Values of a column, NaN where missing; `wanted` names it in messages.
    pub(super) fn values(
        &self,
        file: &str,
        index: usize,
        wanted: &str,
        strict: bool,
    ) -> Result<Vec<f64>, LogError> {
        match self {
            Self::Text(text) => text.values(file, index, wanted, strict),
            Self::Parquet(table) => table.values(file, index, wanted),
            Self::Mat(variables) => variables.values(file, index, wanted),
        }
    }

    /// Describes a row as a reader of the file would count it.
    pub(super) fn place(&self, row: usize) -> String {
        match self {
            Self::Text(text) => format!("line {}", text.line(row)),
            Self::Parquet(_) => format!("row {}", row + 1),
            Self::Mat(_) => format!("element {}", row + 1),
        }
    }
}
