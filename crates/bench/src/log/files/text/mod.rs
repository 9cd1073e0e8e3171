//! Text logs: one line per sample, fields with a separator, comments from `#` or `%`, an optional
//! header line with names, and an optional line with units under it.

mod detect;
pub(super) mod number;
mod numbers;
pub(super) mod records;
mod table;

use super::file::LogFile;
use crate::log::{LogError, TextFormat};
use detect::detect;
use number::is_units;
use records::{Refusal, fields, for_each_row, marked_lines, without_comments};
use table::{Flaw, Table};

/// Text split into columns.
pub(super) struct Text {
    header: Vec<String>,
    /// Fields of the line of units; empty without one.
    units: Vec<String>,
    table: Table,
    format: TextFormat,
    is_described: bool,
    /// The `[log]` table that the text looks like.
    detected: Option<TextFormat>,
}

impl Text {
    /// Splits a text in the described format, else in the detected one, else as the project's own
    /// CSV.
    pub(super) fn open(file: &str, text: &str, described: Option<&TextFormat>) -> Result<Self, LogError> {
        let detected = detect(text);
        let format = described.copied().or(detected).unwrap_or_default();
        let refuse = |(found, expected): Refusal| LogError::content(file, found, expected);
        let text = without_comments(text);
        let marked = marked_lines(&text);
        let (mut header, mut units, mut table) = (None, Vec::new(), None);
        let new_table = |width| Table::new(width, format.decimal_comma, text.len());
        for_each_row(&text, format.separator, |line, row| {
            if format.header && header.is_none() {
                header = Some(fields(row));
                return Ok(());
            }
            if header.is_some() && table.is_none() && units.is_empty() {
                let row = fields(row);
                if is_units(&row, format.decimal_comma) || marked == 2 {
                    units = row;
                    return Ok(());
                }
            }
            let table = match &mut table {
                Some(table) => table,
                None => table.insert(new_table(header.as_ref().map_or(row.len(), Vec::len))?),
            };
            table.add(line, row)
        })
        .map_err(refuse)?;
        if format.header && header.is_none() {
            return Err(LogError::content(file, "an empty file", "a header line with channel names"));
        }
        let header = header.unwrap_or_default();
        let table = table.map_or_else(|| new_table(header.len()), Ok).map_err(refuse)?;
        let text = Self { header, units, table, format, is_described: described.is_some(), detected };
        match text.table.surplus() {
            // In another format the reader names the missing columns first.
            Some(surplus) if detected == Some(format) => {
                let found = format!("{} in line {}", surplus.found, text.table.line(surplus.row));
                let expected = format!("at most {}, as many as columns", text.table.width());
                Err(LogError::content(file, found, expected))
            }
            _ => Ok(text),
        }
    }
}

impl LogFile for Text {
    fn format(&self) -> &'static str {
        "text"
    }

    fn names(&self) -> &[String] {
        &self.header
    }

    fn unit(&self, index: usize) -> &str {
        self.units.get(index).map_or("", String::as_str)
    }

    /// Number of names, without a header of fields of the first row.
    fn width(&self) -> usize {
        self.table.width()
    }

    fn detected(&self) -> Option<TextFormat> {
        self.detected
    }

    fn hint(&self) -> String {
        match self.detected {
            Some(format) if format != self.format => {
                format!("; the file looks like `[log]` with {}", format.lines().join(", "))
            }
            None if !self.is_described && self.header.len() < 2 => {
                "; no separator divides the text into columns of numbers, so commas were assumed".into()
            }
            _ => String::new(),
        }
    }

    fn expected_name(&self, name: &str) -> String {
        format!("a header with `{name}`")
    }

    fn place(&self, row: usize) -> String {
        format!("line {}", self.table.line(row))
    }

    fn values(&self, file: &str, index: usize, wanted: &str, is_strict: bool) -> Result<Vec<f64>, LogError> {
        let surplus = self.table.surplus().cloned().map_or(Ok(()), Err);
        let values = surplus.and_then(|()| self.table.values(index, is_strict));
        values.map_err(|Flaw { row, found, expected }| LogError::Field {
            file: file.into(),
            place: self.place(row),
            column: wanted.into(),
            found,
            expected,
        })
    }
}
