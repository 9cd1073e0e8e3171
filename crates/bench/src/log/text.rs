//! Text logs: one line per sample, fields with a separator, comments from `#`, an optional header
//! line with names.

use super::LogError;
use crate::log::{Separator, TextFormat};

/// Entries that loggers write in place of a missing reading.
const MISSING: [&str; 8] = ["", "nan", "na", "n/a", "null", "none", "inf", "-inf"];

/// Text split into fields.
pub(super) struct Text {
    pub(super) header: Vec<String>,
    rows: Vec<(u64, Vec<String>)>,
}

impl Text {
    pub(super) fn open(file: &str, text: &str, format: &TextFormat) -> Result<Self, LogError> {
        let mut rows = rows(file, text, format.separator)?;
        if !format.header {
            return Ok(Self { header: Vec::new(), rows });
        }
        if rows.is_empty() {
            return Err(LogError::content(file, "an empty file", "a header line with channel names"));
        }
        let header = rows.remove(0).1;
        Ok(Self { header, rows })
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
        self.rows.iter().map(|(line, row)| number(file, *line, row, index, wanted, strict)).collect()
    }
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

fn number(
    file: &str,
    line: u64,
    row: &[String],
    index: usize,
    column: &str,
    strict: bool,
) -> Result<f64, LogError> {
    let refuse = |found: String, expected| LogError::Field {
        file: file.into(),
        place: format!("line {line}"),
        column: column.into(),
        found,
        expected,
    };
    let Some(field) = row.get(index) else {
        return if strict {
            Err(refuse(format!("only {} fields", row.len()), "a field in every column"))
        } else {
            Ok(f64::NAN)
        };
    };
    match field.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ if !strict && MISSING.iter().any(|m| field.eq_ignore_ascii_case(m)) => Ok(f64::NAN),
        _ => Err(refuse(format!("`{field}`"), "a finite number")),
    }
}
