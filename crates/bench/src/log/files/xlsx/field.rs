//! Content and name of a cell of a workbook.

use crate::log::files::text::number::{is_missing, parse};
use calamine::DataRef;

/// Content of a cell. Dates, times and durations are in days.
#[derive(Clone, Debug)]
pub(super) enum Field {
    /// Nothing, a marker of a missing value, or an error such as `#N/A`.
    Empty,
    Number(f64),
    Date(f64),
    Duration(f64),
    Text(String),
}

impl Field {
    pub(super) fn from_cell(value: &DataRef<'_>) -> Self {
        match value {
            DataRef::Int(value) => Self::Number(*value as f64),
            DataRef::Float(value) => Self::Number(*value),
            DataRef::Bool(value) => Self::Number(f64::from(u8::from(*value))),
            DataRef::DateTime(time) if time.is_duration() => Self::Duration(time.as_f64()),
            DataRef::DateTime(time) => Self::Date(time.as_f64()),
            DataRef::String(text) | DataRef::DateTimeIso(text) | DataRef::DurationIso(text) => {
                Self::from_text(text.trim())
            }
            DataRef::SharedString(text) => Self::from_text(text.trim()),
            DataRef::Error(_) | DataRef::Empty => Self::Empty,
        }
    }

    fn from_text(text: &str) -> Self {
        if is_missing(text) { Self::Empty } else { Self::Text(text.to_owned()) }
    }

    pub(super) fn is_empty(&self) -> bool {
        matches!(self, Self::Empty)
    }

    /// Returns whether this is a number or a date. The text `1` may also be a unit.
    pub(super) fn is_reading(&self) -> bool {
        match self {
            Self::Empty => false,
            Self::Text(text) => text != "1" && parse(text, false).is_some(),
            Self::Number(_) | Self::Date(_) | Self::Duration(_) => true,
        }
    }

    /// Content as a name or a unit.
    pub(super) fn text(&self) -> String {
        match self {
            Self::Empty => String::new(),
            Self::Number(value) | Self::Date(value) | Self::Duration(value) => value.to_string(),
            Self::Text(text) => text.clone(),
        }
    }
}

/// Letters of a column from 0: `A`, `Z`, `AA`.
pub(super) fn letters(column: usize) -> String {
    let letter = char::from(b'A' + (column % 26) as u8);
    let before = if column < 26 { String::new() } else { letters(column / 26 - 1) };
    format!("{before}{letter}")
}

/// Name of a cell by row and column from 0: `B5`.
pub(super) fn cell_name(row: u32, column: usize) -> String {
    format!("{}{}", letters(column), u64::from(row) + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_named_as_in_a_spreadsheet() {
        for (column, name) in
            [(0, "A"), (25, "Z"), (26, "AA"), (51, "AZ"), (52, "BA"), (701, "ZZ"), (702, "AAA")]
        {
            assert_eq!(letters(column), name);
        }
        assert_eq!(cell_name(4, 1), "B5");
    }
}
