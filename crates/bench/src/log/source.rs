//! A log's file, split into columns by name. The format is detected from the first bytes, never
//! from the name alone.

use super::LogError;
use super::mat::Variables;
use super::parquet::Table;
use super::text::Text;
use crate::log::TextFormat;

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
    /// Opens a file and splits it into columns; a text in the described format or a detected one.
    pub(super) fn open(file: &str, bytes: Vec<u8>, described: Option<&TextFormat>) -> Result<Self, LogError> {
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
        let Some(text) = decoded(bytes) else {
            return Err(LogError::content(
                file,
                "an unknown binary file",
                "CSV text in UTF-8, Parquet, or a MAT-file of version 5 to 7",
            ));
        };
        Text::open(file, &text, described).map(Self::Text)
    }

    /// Text format as detected; the default for a binary file, whose columns have names.
    pub(super) fn detected(&self) -> Option<TextFormat> {
        if let Self::Text(text) = self { text.detected } else { Some(TextFormat::default()) }
    }

    /// Clause about the text format that the file seems to have, if it is read in another one.
    pub(super) fn hint(&self) -> String {
        if let Self::Text(text) = self { text.hint() } else { String::new() }
    }

    /// Number of columns.
    pub(super) fn width(&self) -> usize {
        match (self.names().len(), self) {
            (0, Self::Text(text)) => text.width(),
            (count, _) => count,
        }
    }

    /// Names of the columns; empty for a text without a header.
    pub(super) fn names(&self) -> &[String] {
        match self {
            Self::Text(text) => &text.header,
            Self::Parquet(table) => &table.names,
            Self::Mat(variables) => &variables.names,
        }
    }

    /// Unit of a column; empty without a line of units.
    pub(super) fn unit(&self, index: usize) -> &str {
        match self {
            Self::Text(text) => text.units.get(index).map_or("", String::as_str),
            Self::Parquet(_) | Self::Mat(_) => "",
        }
    }

    /// Names of the columns for a message.
    pub(super) fn list(&self) -> String {
        if self.names().is_empty() {
            return format!("{} columns without a header", self.width());
        }
        format!("`{}`", self.names().join("`, `"))
    }

    /// Place where a name of a column is expected.
    pub(super) fn expected_name(&self, name: &str) -> String {
        match self {
            Self::Text(_) => format!("a header with `{name}`"),
            Self::Parquet(_) => format!("a column `{name}`"),
            Self::Mat(_) => {
                format!("a variable `{name}` (a field of a struct is `data.{name}`, a column `{name}(:,1)`)")
            }
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

/// Decodes a text: UTF-16 with a byte order mark, UTF-8, else Latin-1. `None` if it contains zeros.
fn decoded(bytes: Vec<u8>) -> Option<String> {
    let utf_16 = |bytes: &[u8], unit: fn([u8; 2]) -> u16| {
        let units = bytes.chunks_exact(2).filter_map(|pair| pair.try_into().ok()).map(unit);
        char::decode_utf16(units).map(|letter| letter.unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
    };
    match bytes.as_slice() {
        [0xff, 0xfe, rest @ ..] => return Some(utf_16(rest, u16::from_le_bytes)),
        [0xfe, 0xff, rest @ ..] => return Some(utf_16(rest, u16::from_be_bytes)),
        _ if bytes.iter().take(SEARCHED_BYTES).any(|&b| b == 0) => return None,
        _ => {}
    }
    let other = |e: std::string::FromUtf8Error| {
        let bytes = e.as_bytes();
        // A byte order mark, or a last character that is cut off: UTF-8 with a damaged place.
        let is_utf_8 = bytes.starts_with(b"\xef\xbb\xbf") || e.utf8_error().error_len().is_none();
        match is_utf_8 {
            true => String::from_utf8_lossy(bytes).into_owned(),
            false => bytes.iter().copied().map(char::from).collect(),
        }
    };
    Some(String::from_utf8(bytes).unwrap_or_else(other))
}
