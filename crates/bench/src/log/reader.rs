//! Reading of a log: selection of the columns, conversion to SI, checks of the values.

use super::source::Source;
use super::{Column, ColumnId, LogError, LogFormat, MAX_ROWS, MeasuredLog, TIME};
use crate::signals::Channel;

/// Reads the content of a file, which messages call `file`. In strict mode missing values and times
/// that do not ascend are refused.
pub(super) fn from_bytes(
    file: &str,
    bytes: Vec<u8>,
    format: &LogFormat,
    strict: bool,
) -> Result<MeasuredLog, LogError> {
    let reader = Reader { file, source: Source::open(file, bytes, &format.text)?, strict };
    let own_time = Column { from: ColumnId::Name(TIME.into()), scale: 1.0, offset: 0.0 };
    let time_column = format.columns.get(TIME).unwrap_or(&own_time);
    let time_index = reader.source.locate(file, time_column)?;
    let selected = reader.select(format)?;
    let mut log = MeasuredLog {
        source: file.into(),
        time_s: reader.values(TIME, time_index, time_column)?,
        ..MeasuredLog::default()
    };
    if strict {
        reader.check_ascending(&log.time_s)?;
    }
    for column in &selected {
        log.channels.insert(column.channel, reader.channel(column, log.time_s.len())?);
    }
    if log.time_s.len() < 2 {
        return Err(reader.content(format!("{} data rows", log.time_s.len()), "at least 2"));
    }
    Ok(log)
}

/// A channel with its column.
struct Selected {
    channel: Channel,
    index: usize,
    column: Column,
}

/// A file that is being read.
struct Reader<'a> {
    file: &'a str,
    source: Source,
    strict: bool,
}

impl Reader<'_> {
    /// Selects the columns of channels: those that the format maps, then those with the name of a
    /// channel.
    fn select(&self, format: &LogFormat) -> Result<Vec<Selected>, LogError> {
        let mut selected: Vec<Selected> = Vec::new();
        for (name, column) in &format.columns {
            if let Some(channel) = Channel::from_name(name) {
                let index = self.source.locate(self.file, column)?;
                selected.push(Selected { channel, index, column: column.clone() });
            }
        }
        for (index, name) in self.source.names().iter().enumerate() {
            if let Some(channel) = Channel::from_name(name)
                && !format.columns.contains_key(channel.name())
            {
                if selected.iter().any(|known| known.channel == channel) {
                    return Err(self.content(format!("the column `{name}` twice"), "every channel once"));
                }
                let column = Column { from: ColumnId::Index(index), scale: 1.0, offset: 0.0 };
                selected.push(Selected { channel, index, column });
            }
        }
        if selected.is_empty() {
            let names = Channel::ALL.iter().map(|c| c.name()).collect::<Vec<_>>().join(", ");
            return Err(self.content(
                format!("no known channel among the columns `{}`", self.source.names().join("`, `")),
                &format!(
                    "some of {names}, or a [columns] table that maps foreign names{}",
                    self.source.hint()
                ),
            ));
        }
        Ok(selected)
    }

    /// Values of a column in SI; in strict mode all finite.
    fn values(&self, name: &str, index: usize, column: &Column) -> Result<Vec<f64>, LogError> {
        let mut values = self.source.values(self.file, index, name, self.strict)?;
        if values.len() > MAX_ROWS {
            return Err(self.content(format!("more than {MAX_ROWS} rows"), "a log divided into several"));
        }
        for value in &mut values {
            *value = column.scale * *value + column.offset;
        }
        match values.iter().position(|v| !v.is_finite()) {
            Some(row) if self.strict => {
                let found = values.get(row).map_or_else(String::new, f64::to_string);
                Err(self.field(row, name, found, "a finite number"))
            }
            _ => Ok(values),
        }
    }

    /// Values of a channel, as many as times.
    fn channel(&self, selected: &Selected, times: usize) -> Result<Vec<f64>, LogError> {
        let Selected { channel, index, column } = selected;
        let values = self.values(channel.name(), *index, column)?;
        if values.len() != times {
            let name = self.source.names().get(*index).map_or_else(|| index.to_string(), Clone::clone);
            return Err(self.content(
                format!("`{name}` for {channel} has {} values", values.len()),
                &format!("{times}, as many as times"),
            ));
        }
        Ok(values)
    }

    fn check_ascending(&self, time_s: &[f64]) -> Result<(), LogError> {
        let found = time_s.windows(2).enumerate().find_map(|(row, pair)| match pair {
            [before, after] if after <= before => Some((row + 1, format!("{after} after {before}"))),
            _ => None,
        });
        match found {
            Some((row, found)) => Err(self.field(row, TIME, found, "times that ascend strictly")),
            None => Ok(()),
        }
    }

    /// Returns the error of one value.
    fn field(&self, row: usize, column: &str, found: String, expected: &'static str) -> LogError {
        let place = self.source.place(row);
        LogError::Field { file: self.file.into(), place, column: column.into(), found, expected }
    }

    /// Returns the error of the file.
    fn content(&self, found: String, expected: &str) -> LogError {
        LogError::content(self.file, found, expected)
    }
}
