//! Reading of a log: selection of the columns, conversion to SI, checks of the values.

use super::expression::{Expression, SyntaxError};
use super::files::{self, LogFile, MAX_ROWS};
use super::{Column, ColumnId, LogError, LogFormat, MeasuredLog, TIME};
use crate::signals::Channel;

/// Reads the content of a file, which messages call `file`. In strict mode missing values and times
/// that do not ascend are refused.
pub(super) fn from_bytes(
    file: &str,
    bytes: Vec<u8>,
    format: &LogFormat,
    strict: bool,
) -> Result<MeasuredLog, LogError> {
    let reader = Reader { file, source: files::open(file, bytes, format.text.as_ref())?, strict };
    let (time, selected) = reader.select(format)?;
    let mut log =
        MeasuredLog { source: file.into(), time_s: reader.values(&time, None)?, ..MeasuredLog::default() };
    if strict {
        reader.check_ascending(&log.time_s)?;
    }
    for (channel, signal) in &selected {
        reader.check_times(&time, signal)?;
        log.channels.insert(*channel, reader.values(signal, Some(log.time_s.len()))?);
    }
    if log.time_s.len() < 2 {
        return Err(reader.content(format!("{} data rows", log.time_s.len()), "at least 2"));
    }
    Ok(log)
}

/// The time or a channel with its source.
struct Signal {
    name: &'static str,
    /// Expression as written.
    text: String,
    expression: Expression,
    scale: f64,
    offset: f64,
}

/// A file that is being read.
struct Reader<'a> {
    file: &'a str,
    source: Box<dyn LogFile>,
    strict: bool,
}

impl Reader<'_> {
    /// Selects the time and the channels: those that the format maps, then those whose name a
    /// column has. All wrong entries of `[columns]` are refused together.
    fn select(&self, format: &LogFormat) -> Result<(Signal, Vec<(Channel, Signal)>), LogError> {
        let mut flaws = Vec::new();
        let mut selected: Vec<(Channel, Signal)> = Vec::new();
        let own_time = Column::from(TIME.to_owned());
        let time = match format.columns.get(TIME) {
            Some(column) => self.signal(TIME, column).map_err(|flaw| format!("columns.{TIME}: {flaw}")),
            None => self.signal(TIME, &own_time),
        };
        let time = time.map_err(|flaw| flaws.push(flaw)).ok();
        for (name, column) in &format.columns {
            if let Some(channel) = Channel::from_name(name) {
                match self.signal(channel.name(), column) {
                    Ok(signal) => selected.push((channel, signal)),
                    Err(flaw) => flaws.push(format!("columns.{name}: {flaw}")),
                }
            }
        }
        let Some(time) = time.filter(|_| flaws.is_empty()) else {
            return Err(LogError::Columns { file: self.file.into(), flaws });
        };
        for (index, name) in self.source.names().iter().enumerate() {
            if let Some(channel) = Channel::from_name(name)
                && !format.columns.contains_key(channel.name())
            {
                if selected.iter().any(|(known, _)| *known == channel) {
                    return Err(self.content(format!("the column `{name}` twice"), "every channel once"));
                }
                let (text, expression) = (name.clone(), Expression::column(index));
                let signal = Signal { name: channel.name(), text, expression, scale: 1.0, offset: 0.0 };
                selected.push((channel, signal));
            }
        }
        if selected.is_empty() {
            let names = Channel::ALL.iter().map(|c| c.name()).collect::<Vec<_>>().join(", ");
            return Err(self.content(
                format!("no known channel among the columns {}", files::list(&*self.source)),
                &format!(
                    "some of {names}, or a [columns] table that maps foreign names{}",
                    self.source.hint()
                ),
            ));
        }
        Ok((time, selected))
    }

    /// Looks up the columns of a signal; the error is what was found and what was expected.
    fn signal(&self, name: &'static str, column: &Column) -> Result<Signal, String> {
        let (text, expression) = match &column.from {
            ColumnId::Index(index) => (index.to_string(), Expression::column(*index)),
            ColumnId::Name(text) => (text.clone(), self.expression(text)?),
        };
        Ok(Signal { name, text, expression, scale: column.scale, offset: column.offset })
    }

    /// Reads a text as the name of a column, else as an expression.
    fn expression(&self, text: &str) -> Result<Expression, String> {
        let locate = |name: &str| self.source.names().iter().position(|known| known == name);
        if let Some(index) = locate(text) {
            return Ok(Expression::column(index));
        }
        let (list, hint) = (files::list(&*self.source), self.source.hint());
        match Expression::parse(text, &locate) {
            Err(SyntaxError { found, position, expected }) => Err(format!(
                "`{text}` is neither a column nor an expression: at character {position} found {found}; \
                 expected {expected}, or a column among {list}{hint}"
            )),
            Ok(expression) if expression.unknown.iter().any(|name| name == text) => Err(format!(
                "no column `{text}` among {list}; expected {}{hint}",
                self.source.expected_name(text)
            )),
            Ok(expression) if !expression.unknown.is_empty() => Err(format!(
                "found `{text}`, but no column is `{}`; expected columns among {list}{hint}",
                expression.unknown.join("` or `")
            )),
            Ok(expression) if expression.columns.is_empty() => Err(format!(
                "found `{text}`, an expression without a column; expected a column among {list}; an index \
                 is `from = 0`, or `column(0)` in an expression"
            )),
            Ok(expression) => match expression.columns.iter().max() {
                Some(last) if *last >= self.source.width() => Err(format!(
                    "found `{text}`, but there is no column({last}); expected columns among {list}{hint}"
                )),
                _ => Ok(expression),
            },
        }
    }

    /// Values of a signal in SI, `count` if it is given; in strict mode all finite.
    fn values(&self, signal: &Signal, count: Option<usize>) -> Result<Vec<f64>, LogError> {
        let mut inputs: Vec<Vec<f64>> = Vec::new();
        for &index in &signal.expression.columns {
            let values = self.source.values(self.file, index, signal.name, self.strict)?;
            if values.len() > MAX_ROWS {
                return Err(self.content(format!("more than {MAX_ROWS} rows"), "a log divided into several"));
            }
            let count = count.or(inputs.first().map(Vec::len)).unwrap_or(values.len());
            if values.len() != count {
                let found = format!("`{}` for {} has {} values", self.name(index), signal.name, values.len());
                let expected = if signal.name == TIME { "the others" } else { "times" };
                return Err(self.content(found, &format!("{count}, as many as {expected}")));
            }
            inputs.push(values);
        }
        let rows = inputs.first().map_or(0, Vec::len);
        let (mut readings, mut stack) = (vec![f64::NAN; inputs.len()], Vec::new());
        let mut out = Vec::with_capacity(rows);
        for row in 0..rows {
            for (reading, input) in readings.iter_mut().zip(&inputs) {
                *reading = input.get(row).copied().unwrap_or(f64::NAN);
            }
            let found = signal.expression.value(&readings, &mut stack);
            if !found.is_finite() && readings.iter().all(|reading| reading.is_finite()) {
                return Err(self.not_finite(signal, row, found, &readings));
            }
            let value = signal.scale * found + signal.offset;
            if self.strict && !value.is_finite() {
                return Err(self.field(row, signal.name, value.to_string(), "a finite number"));
            }
            out.push(value);
        }
        Ok(out)
    }

    /// Returns the error of an expression without a finite value: a division by zero, a root of a
    /// negative number.
    fn not_finite(&self, signal: &Signal, row: usize, found: f64, readings: &[f64]) -> LogError {
        let columns = signal.expression.columns.iter().zip(readings);
        let columns = columns.map(|(index, value)| format!("{} = {value}", self.name(*index)));
        let columns = columns.collect::<Vec<_>>().join(", ");
        let found = format!("{found} from `{}` with {columns}", signal.text);
        self.field(row, signal.name, found, "a finite number")
    }

    /// Name of a column, or its index without a name.
    fn name(&self, index: usize) -> String {
        self.source.names().get(index).map_or_else(|| format!("column({index})"), Clone::clone)
    }

    /// Refuses a signal whose times, as the file states them, are not those of the log.
    fn check_times(&self, time: &Signal, signal: &Signal) -> Result<(), LogError> {
        let Some(of_log) = time.expression.columns.iter().find_map(|index| self.source.time_of(*index))
        else {
            return Ok(());
        };
        let of_log_name = self.name(of_log);
        let expected = format!(
            "a column with the times `{of_log_name}`; `log convert` gives all columns one time with --rate"
        );
        for index in &signal.expression.columns {
            let name = self.name(*index);
            let Some(own) = self.source.time_of(*index) else {
                let found = format!("`{name}` for {}, a column without times", signal.name);
                return Err(self.content(found, &expected));
            };
            let values = |index: usize| self.source.values(self.file, index, TIME, false);
            if own != of_log && values(own)? != values(of_log)? {
                let found = format!("`{name}` for {} with the times `{}`", signal.name, self.name(own));
                return Err(self.content(found, &expected));
            }
        }
        Ok(())
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
