//! Measured logs: one row a sample, one column a channel, CSV.

use crate::atomic;
use crate::channel::{Channel, Role};
use crate::log_format::{Column, ColumnId, LogFormat, Separator, TIME};
use std::collections::BTreeMap;
use std::path::Path;

/// Rows a log may have: bounds memory on hostile input.
const MOST_ROWS: usize = 20_000_000;

/// A log in SI.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeasuredLog {
    /// Where it came from, for messages.
    pub source: String,
    /// Time of each sample in s, strictly ascending.
    pub time_s: Vec<f64>,
    /// Signals by channel, each as long as the time.
    pub channels: BTreeMap<Channel, Vec<f64>>,
}

/// Why a log was refused.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The file could not be read or written.
    #[error("{file}: {source}")]
    Io {
        /// Path.
        file: String,
        /// Cause.
        source: std::io::Error,
    },
    /// A field is not what it should be.
    #[error("{file}: line {line}, {column}: found {found}; expected {expected}")]
    Field {
        /// Path.
        file: String,
        /// Line from 1.
        line: u64,
        /// Column by name or index.
        column: String,
        /// What stands there.
        found: String,
        /// What may stand there.
        expected: &'static str,
    },
    /// The log as a whole lacks something.
    #[error("{file}: {found}; expected {expected}")]
    Content {
        /// Path.
        file: String,
        /// What was found.
        found: String,
        /// What is needed.
        expected: String,
    },
}

impl MeasuredLog {
    /// Reads a log through a format. Columns that are no channel are left out.
    pub fn read(path: &Path, format: &LogFormat) -> Result<Self, LogError> {
        let file = path.display().to_string();
        let bytes = std::fs::read(path).map_err(|source| LogError::Io { file: file.clone(), source })?;
        let text = String::from_utf8_lossy(&bytes);
        Self::parse(&file, &text, format)
    }

    /// Parses a log; `file` names it in messages.
    pub fn parse(file: &str, text: &str, format: &LogFormat) -> Result<Self, LogError> {
        let content = |found: String, expected: &str| LogError::Content {
            file: file.into(),
            found,
            expected: expected.into(),
        };
        let mut rows = rows(file, text, format.text.separator)?.into_iter();
        let header = if format.text.header {
            rows.next().ok_or_else(|| content("an empty file".into(), "a header line with channel names"))?.1
        } else {
            Vec::new()
        };
        let own_time = Column { from: ColumnId::Name(TIME.into()), scale: 1.0, offset: 0.0 };
        let time_column = format.columns.get(TIME).unwrap_or(&own_time);
        let time = locate(file, &header, time_column)?;
        let mut wanted: Vec<(Channel, usize, &Column)> = Vec::new();
        for (name, column) in &format.columns {
            if let Some(channel) = Channel::from_name(name) {
                wanted.push((channel, locate(file, &header, column)?, column));
            }
        }
        let plain = Column { from: ColumnId::Index(0), scale: 1.0, offset: 0.0 };
        for (index, name) in header.iter().enumerate() {
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
                format!("no known channel among the columns `{}`", header.join("`, `")),
                &format!("some of {names}, or a [columns] table that maps foreign names"),
            ));
        }
        let mut log = Self { source: file.into(), ..Self::default() };
        let mut columns: Vec<Vec<f64>> = vec![Vec::new(); wanted.len()];
        for (line, row) in rows {
            let t = time_column.scale * number(file, line, &row, time, TIME)? + time_column.offset;
            if let Some(&last) = log.time_s.last()
                && t <= last
            {
                return Err(LogError::Field {
                    file: file.into(),
                    line,
                    column: "t_s".into(),
                    found: format!("{t} after {last}"),
                    expected: "times that ascend strictly",
                });
            }
            log.time_s.push(t);
            for ((channel, index, column), values) in wanted.iter().zip(&mut columns) {
                values.push(column.scale * number(file, line, &row, *index, channel.name())? + column.offset);
            }
            if log.time_s.len() > MOST_ROWS {
                return Err(content(format!("more than {MOST_ROWS} rows"), "a log cut into sessions"));
            }
        }
        if log.time_s.len() < 2 {
            return Err(content(format!("{} data rows", log.time_s.len()), "at least 2"));
        }
        log.channels = wanted.iter().map(|(channel, ..)| *channel).zip(columns).collect();
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

    /// Writes the log as CSV, whole or not at all.
    pub fn write(&self, path: &Path) -> Result<(), LogError> {
        atomic::write(path, self.to_csv().as_bytes())
            .map_err(|source| LogError::Io { file: path.display().to_string(), source })
    }

    /// A channel, or a refusal that names it.
    pub fn need(&self, channel: Channel) -> Result<&[f64], LogError> {
        self.channels.get(&channel).map(Vec::as_slice).ok_or_else(|| self.missing(channel))
    }

    /// The refusal of a log that lacks a channel.
    pub fn missing(&self, channel: Channel) -> LogError {
        LogError::Content {
            file: self.source.clone(),
            found: format!("no column `{channel}`"),
            expected: format!("the input `{channel}` of this plant"),
        }
    }

    /// The output channels of the log.
    pub fn outputs(&self) -> impl Iterator<Item = (Channel, &[f64])> {
        self.channels.iter().filter(|(c, _)| c.role() == Role::Output).map(|(c, v)| (*c, v.as_slice()))
    }
}

fn rows(file: &str, text: &str, separator: Separator) -> Result<Vec<(u64, Vec<String>)>, LogError> {
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
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .delimiter(delimiter)
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .flexible(true)
        .from_reader(text.as_bytes());
    let mut out = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|e| LogError::Content {
            file: file.into(),
            found: e.to_string(),
            expected: "readable CSV".into(),
        })?;
        let line = record.position().map_or(0, csv::Position::line);
        out.push((line, record.iter().map(str::to_owned).collect()));
    }
    Ok(out)
}

fn locate(file: &str, header: &[String], column: &Column) -> Result<usize, LogError> {
    match &column.from {
        ColumnId::Index(index) => Ok(*index),
        ColumnId::Name(name) => header.iter().position(|h| h == name).ok_or_else(|| LogError::Content {
            file: file.into(),
            found: format!("no column `{name}` among `{}`", header.join("`, `")),
            expected: format!("a header with `{name}`"),
        }),
    }
}

fn number(file: &str, line: u64, row: &[String], index: usize, column: &str) -> Result<f64, LogError> {
    let refuse = |found: String, expected| LogError::Field {
        file: file.into(),
        line,
        column: column.into(),
        found,
        expected,
    };
    let field = row
        .get(index)
        .ok_or_else(|| refuse(format!("only {} fields", row.len()), "a field in every column"))?;
    match field.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(refuse(format!("`{field}`"), "a finite number")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log_format::TextFormat;
    use proptest::prelude::*;

    fn own() -> LogFormat {
        LogFormat::default()
    }

    #[test]
    fn refusals_name_file_line_and_column() {
        for (text, expected) in [
            ("", "an empty file"),
            ("t_s,journal_y_m\n0,1\n", "1 data rows"),
            ("t_s,journal_y_m\n0,1\n0,2\n", "line 3, t_s: found 0 after 0"),
            ("t_s,journal_y_m\n0,1\n1,x\n", "line 3, journal_y_m: found `x`"),
            ("t_s,journal_y_m\n0,1\n1,nan\n", "line 3, journal_y_m: found `nan`"),
            ("t_s,journal_y_m\n0,1\n1\n", "only 1 fields"),
            ("time,journal_y_m\n0,1\n1,2\n", "no column `t_s`"),
            ("t_s,apples\n0,1\n1,2\n", "no known channel"),
            ("t_s,journal_y_m,journal_y_m\n0,1,1\n1,2,2\n", "twice"),
        ] {
            let error = MeasuredLog::parse("a.csv", text, &own()).unwrap_err().to_string();
            assert!(error.starts_with("a.csv") && error.contains(expected), "{error}");
        }
    }

    #[test]
    fn a_foreign_log_is_mapped_scaled_and_shifted() {
        let columns = toml::from_str(
            "t_s = { from = 0, scale = 1e-3 }\nposition_m = { from = 2, scale = 1e-3, offset = 1.0 }\n",
        )
        .unwrap();
        let text = TextFormat { separator: Separator::Whitespace, header: false };
        let format = LogFormat { text, columns };
        let log = MeasuredLog::parse("x", "0.0\t7 5.0\r\n10.0  7 6.0\r\n", &format).unwrap();
        assert_eq!(log.time_s, [0.0, 0.01]);
        assert_eq!(log.channels[&Channel::Position], [1.005, 1.006]);
    }

    proptest! {
        #[test]
        fn csv_reads_back_exactly(values in proptest::collection::vec(-1e9..1e9_f64, 2..50)) {
            let log = MeasuredLog {
                source: "x".into(),
                time_s: (0..values.len()).map(|i| i as f64 * 1e-3).collect(),
                channels: BTreeMap::from([(Channel::JournalY, values)]),
            };
            prop_assert_eq!(MeasuredLog::parse("x", &log.to_csv(), &own()).unwrap(), log);
        }

        #[test]
        fn garbage_is_refused_without_panic(text in "\\PC{0,200}") {
            let _ = MeasuredLog::parse("x", &text, &own());
        }
    }
}
