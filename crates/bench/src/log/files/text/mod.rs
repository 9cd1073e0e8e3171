//! Text logs: one line per sample, fields with a separator, comments from `#` or `%`, an optional
//! header line with names, and an optional line with units under it.

mod detect;
pub(super) mod number;

use super::file::LogFile;
use crate::log::{LogError, Separator, TextFormat};
use detect::detect;
use number::{NO_THOUSANDS, has_thousands, is_missing, is_units, parse};
use std::borrow::Cow;

/// Line from 1, and fields.
type Row = (u64, Vec<String>);

/// Text split into fields.
pub(super) struct Text {
    header: Vec<String>,
    /// Fields of the line of units; empty without one.
    units: Vec<String>,
    rows: Vec<Row>,
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
        let readable = |e: csv::Error| LogError::content(file, e.to_string(), "readable CSV");
        let mut rows = split(text, format.separator).map_err(readable)?;
        let (mut header, mut units) = (Vec::new(), Vec::new());
        if format.header {
            if rows.is_empty() {
                return Err(LogError::content(file, "an empty file", "a header line with channel names"));
            }
            header = rows.remove(0).1;
            if rows.first().is_some_and(|(_, row)| is_units(row, format.decimal_comma)) {
                units = rows.remove(0).1;
            }
        }
        Ok(Self { header, units, rows, format, is_described: described.is_some(), detected })
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
        match self.header.len() {
            0 => self.rows.first().map_or(0, |(_, row)| row.len()),
            count => count,
        }
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
        format!("line {}", self.rows.get(row).map_or(0, |(line, _)| *line))
    }

    fn values(&self, file: &str, index: usize, wanted: &str, is_strict: bool) -> Result<Vec<f64>, LogError> {
        let cell = Cell { file, index, column: wanted, is_strict, decimal_comma: self.format.decimal_comma };
        self.rows.iter().map(|(line, row)| cell.number(*line, row)).collect()
    }
}

/// Splits a text into rows of trimmed fields.
fn split(text: &str, separator: Separator) -> Result<Vec<Row>, csv::Error> {
    let text = without_comments(text.strip_prefix('\u{feff}').unwrap_or(text));
    let delimiter = match separator {
        Separator::Whitespace => {
            let rows = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
            let fields = |line: &str| line.split_whitespace().map(str::to_owned).collect();
            return Ok(rows.map(|(i, line)| (i as u64 + 1, fields(line))).collect());
        }
        Separator::Comma => b',',
        Separator::Semicolon => b';',
        Separator::Tab => b'\t',
    };
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .delimiter(delimiter)
        .trim(csv::Trim::All)
        .flexible(true)
        .from_reader(text.as_bytes());
    let mut out = Vec::new();
    for record in reader.records() {
        let record = record?;
        let line = record.position().map_or(0, csv::Position::line);
        out.push((line, record.iter().map(str::to_owned).collect()));
    }
    Ok(out)
}

/// Replaces comments by empty lines, so that the other lines keep their numbers. The separator that
/// a spreadsheet states in the first line counts as a comment too.
fn without_comments(text: &str) -> Cow<'_, str> {
    // `%name` may be the name of a column.
    let is_comment = |line: &str| {
        let after = |sign| line.strip_prefix(sign);
        after('#').is_some()
            || after('%').is_some_and(|rest| !rest.starts_with(|c: char| c.is_alphanumeric()))
    };
    let is_separator = text.starts_with("sep=") && text.lines().next().is_some_and(|line| line.len() == 5);
    if !is_separator && !text.lines().any(is_comment) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len());
    for (index, line) in text.lines().enumerate() {
        if !(is_comment(line) || is_separator && index == 0) {
            out.push_str(line);
        }
        out.push('\n');
    }
    Cow::Owned(out)
}

/// Place and form of a number in each row.
struct Cell<'a> {
    file: &'a str,
    index: usize,
    /// Name of the column for messages.
    column: &'a str,
    is_strict: bool,
    decimal_comma: bool,
}

impl Cell<'_> {
    fn number(&self, line: u64, row: &[String]) -> Result<f64, LogError> {
        let refuse = |found: String, expected| LogError::Field {
            file: self.file.into(),
            place: format!("line {line}"),
            column: self.column.into(),
            found,
            expected,
        };
        let Some(field) = row.get(self.index) else {
            return if self.is_strict {
                Err(refuse(format!("only {} fields", row.len()), "a field in every column"))
            } else {
                Ok(f64::NAN)
            };
        };
        match parse(field, self.decimal_comma) {
            Some(value) => Ok(value),
            None if !self.is_strict && is_missing(field) => Ok(f64::NAN),
            None => Err(refuse(format!("`{field}`"), self.expected(field))),
        }
    }

    /// Content expected in place of a field that is no number.
    fn expected(&self, field: &str) -> &'static str {
        if has_thousands(field, self.decimal_comma) {
            NO_THOUSANDS
        } else if self.decimal_comma && parse(field, false).is_some() {
            "a number with a decimal comma and without separators of thousands"
        } else if !self.decimal_comma && parse(field, true).is_some() {
            "a number with a decimal point; for decimal commas set `decimal_comma = true` in `[log]`"
        } else {
            "a finite number"
        }
    }
}
