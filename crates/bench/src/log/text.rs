//! Text logs: one line per sample, fields with a separator, comments from `#`, an optional header
//! line with names.

use super::LogError;
use super::detect::detect;
use crate::log::{Separator, TextFormat};

/// Entries that loggers write in place of a missing reading.
pub(super) const MISSING: [&str; 8] = ["", "nan", "na", "n/a", "null", "none", "inf", "-inf"];

/// Text split into fields.
pub(super) struct Text {
    pub(super) header: Vec<String>,
    rows: Vec<(u64, Vec<String>)>,
    decimal_comma: bool,
    /// The `[log]` table that the text looks like, if another one is described.
    pub(super) other_format: Option<TextFormat>,
}

impl Text {
    pub(super) fn open(file: &str, text: &str, format: &TextFormat) -> Result<Self, LogError> {
        let (mut rows, decimal_comma) = (rows(file, text, format.separator)?, format.decimal_comma);
        let other_format = detect(text).filter(|detected| detected != format);
        if !format.header {
            return Ok(Self { header: Vec::new(), rows, decimal_comma, other_format });
        }
        if rows.is_empty() {
            return Err(LogError::content(file, "an empty file", "a header line with channel names"));
        }
        let header = rows.remove(0).1;
        Ok(Self { header, rows, decimal_comma, other_format })
    }

    /// Number of fields of the first row.
    pub(super) fn width(&self) -> usize {
        self.rows.first().map_or(0, |(_, row)| row.len())
    }

    pub(super) fn line(&self, row: usize) -> u64 {
        self.rows.get(row).map_or(0, |(line, _)| *line)
    }

    pub(super) fn values(
        &self,
        file: &str,
        index: usize,
        wanted: &str,
        strict: bool,
    ) -> Result<Vec<f64>, LogError> {
        let cell = Cell { file, index, column: wanted, strict, decimal_comma: self.decimal_comma };
        self.rows.iter().map(|(line, row)| cell.number(*line, row)).collect()
    }
}

/// Fields of one line without quotes.
pub(super) fn fields_of(line: &str, separator: Separator) -> impl Iterator<Item = &str> {
    let delimiter = match separator {
        Separator::Whitespace => None,
        Separator::Comma => Some(','),
        Separator::Semicolon => Some(';'),
        Separator::Tab => Some('\t'),
    };
    let blanks = delimiter.is_none().then(|| line.split_whitespace());
    let fields = delimiter.map(|delimiter| line.split(delimiter).map(str::trim));
    blanks.into_iter().flatten().chain(fields.into_iter().flatten())
}

/// Parses a finite number; with `decimal_comma` the comma is the decimal sign.
pub(super) fn parse(field: &str, decimal_comma: bool) -> Option<f64> {
    let number = if decimal_comma && field.contains(',') {
        field.replacen(',', ".", 1).parse::<f64>()
    } else {
        field.parse()
    };
    number.ok().filter(|value| value.is_finite())
}

fn rows(file: &str, text: &str, separator: Separator) -> Result<Vec<(u64, Vec<String>)>, LogError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let delimiter = match separator {
        Separator::Whitespace => {
            return Ok(text
                .lines()
                .enumerate()
                .filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'))
                .map(|(i, line)| (i as u64 + 1, line.split_whitespace().map(str::to_owned).collect()))
                .collect());
        }
        Separator::Comma => b',',
        Separator::Semicolon => b';',
        Separator::Tab => b'\t',
    };
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .delimiter(delimiter)
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .flexible(true)
        .from_reader(text.as_bytes());
    let mut out = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|e| LogError::content(file, e.to_string(), "readable CSV"))?;
        let line = record.position().map_or(0, csv::Position::line);
        out.push((line, record.iter().map(str::to_owned).collect()));
    }
    Ok(out)
}

/// Place and form of a number in each row.
struct Cell<'a> {
    file: &'a str,
    index: usize,
    /// Name of the column for messages.
    column: &'a str,
    strict: bool,
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
            return if self.strict {
                Err(refuse(format!("only {} fields", row.len()), "a field in every column"))
            } else {
                Ok(f64::NAN)
            };
        };
        match parse(field, self.decimal_comma) {
            Some(value) => Ok(value),
            None if !self.strict && MISSING.iter().any(|m| field.eq_ignore_ascii_case(m)) => Ok(f64::NAN),
            None if parse(field, true).is_some() => Err(refuse(
                format!("`{field}`"),
                "a number with a decimal point; for decimal commas set `decimal_comma = true` in `[log]`",
            )),
            None => Err(refuse(format!("`{field}`"), "a finite number")),
        }
    }
}
