//! Columns of numbers of a text, added row by row. The text itself is not kept.

use super::number::{NO_THOUSANDS, has_thousands, is_missing, parse};
use super::numbers::Numbers;
use super::records::Refusal;
use crate::log::files::file::{MAX_NAMES, MAX_ROWS, MAX_VALUES};
use csv::StringRecord;

/// Field that cannot be read.
#[derive(Clone)]
pub(super) struct Flaw {
    /// Row from 0.
    pub(super) row: usize,
    pub(super) found: String,
    pub(super) expected: &'static str,
}

/// Column of a text.
#[derive(Default)]
struct Column {
    /// Numbers, NaN where missing; empty with a text.
    values: Numbers,
    /// First field that is neither a number nor a missing value.
    text: Option<Flaw>,
    /// First missing value.
    gap: Option<Flaw>,
}

impl Column {
    fn add(&mut self, row: usize, field: Option<&str>, fields: usize, decimal_comma: bool) {
        if self.text.is_some() {
            return;
        }
        let value = field.and_then(|field| parse(field, decimal_comma));
        self.values.push(value.unwrap_or(f64::NAN));
        match field {
            _ if value.is_some() => {}
            Some(field) if !is_missing(field) => {
                let expected = expected(field, decimal_comma);
                self.text = Some(Flaw { row, found: format!("`{field}`"), expected });
                self.values = Numbers::default();
            }
            _ if self.gap.is_some() => {}
            Some(field) => {
                self.gap = Some(Flaw { row, found: format!("`{field}`"), expected: "a finite number" });
            }
            None => self.gap = Some(too_short(row, fields)),
        }
    }
}

/// Columns of a text.
pub(super) struct Table {
    columns: Vec<Column>,
    decimal_comma: bool,
    rows: usize,
    max_rows: usize,
    /// Maximum number of values. A text has more than one byte per value, unless rows are short.
    max_values: usize,
    /// Rows from 0 with their lines from 1, where the line before is not that of the row before.
    lines: Vec<(usize, u64)>,
    /// First row with more fields than columns.
    surplus: Option<Flaw>,
}

impl Table {
    /// Returns an empty table for a text with a number of bytes.
    pub(super) fn new(width: usize, decimal_comma: bool, bytes: usize) -> Result<Self, Refusal> {
        if width > MAX_NAMES {
            return Err((format!("more than {MAX_NAMES} columns"), "a text of fewer columns"));
        }
        Ok(Self {
            columns: (0..width).map(|_| Column::default()).collect(),
            decimal_comma,
            rows: 0,
            max_rows: MAX_ROWS,
            max_values: MAX_VALUES.max(bytes),
            lines: Vec::new(),
            surplus: None,
        })
    }

    /// Adds a row of fields in a line from 1.
    pub(super) fn add(&mut self, line: u64, fields: &StringRecord) -> Result<(), Refusal> {
        let (row, width) = (self.rows, self.columns.len());
        self.rows += 1;
        if self.rows > self.max_rows {
            return Err((format!("more than {} rows", self.max_rows), "a log divided into several"));
        }
        if self.rows.saturating_mul(width) > self.max_values {
            return Err((format!("more than {} values", self.max_values), "a log divided into several"));
        }
        if self.lines.last().is_none_or(|(known, first)| first + (row - known) as u64 != line) {
            self.lines.push((row, line));
        }
        for (place, column) in self.columns.iter_mut().enumerate() {
            column.add(row, fields.get(place), fields.len(), self.decimal_comma);
        }
        let last =
            (width..fields.len()).rev().find(|place| fields.get(*place).is_some_and(|f| !f.is_empty()));
        if let Some(last) = last.filter(|_| self.surplus.is_none()) {
            let found = format!("{} fields", last + 1);
            self.surplus = Some(Flaw { row, found, expected: "at most one for each column" });
        }
        Ok(())
    }

    pub(super) fn width(&self) -> usize {
        self.columns.len()
    }

    /// First row with more fields than columns.
    pub(super) fn surplus(&self) -> Option<&Flaw> {
        self.surplus.as_ref()
    }

    /// Line from 1 of a row from 0.
    pub(super) fn line(&self, row: usize) -> u64 {
        let after = self.lines.partition_point(|(first, _)| *first <= row);
        let known = after.checked_sub(1).and_then(|index| self.lines.get(index));
        known.map_or(0, |(first, line)| line + (row - first) as u64)
    }

    /// Values of a column, NaN where missing; in strict mode a missing value is refused.
    pub(super) fn values(&self, index: usize, is_strict: bool) -> Result<Vec<f64>, Flaw> {
        let Some(column) = self.columns.get(index) else {
            let is_refused = is_strict && self.rows > 0;
            let missing = || vec![f64::NAN; self.rows];
            return if is_refused { Err(too_short(0, self.width())) } else { Ok(missing()) };
        };
        let gap = column.gap.as_ref().filter(|_| is_strict);
        match column.text.iter().chain(gap).min_by_key(|flaw| flaw.row) {
            Some(flaw) => Err(flaw.clone()),
            None => Ok(column.values.values()),
        }
    }
}

fn too_short(row: usize, fields: usize) -> Flaw {
    Flaw { row, found: format!("only {fields} fields"), expected: "a field in every column" }
}

/// Content expected in place of a field that is no number.
fn expected(field: &str, decimal_comma: bool) -> &'static str {
    if has_thousands(field, decimal_comma) {
        NO_THOUSANDS
    } else if decimal_comma && parse(field, false).is_some() {
        "a number with a decimal comma and without separators of thousands"
    } else if !decimal_comma && parse(field, true).is_some() {
        "a number with a decimal point; for decimal commas set `decimal_comma = true` in `[log]`"
    } else {
        "a finite number"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(rows: &[(u64, &[&str])]) -> Table {
        let mut table = Table::new(2, false, 0).unwrap();
        for (line, fields) in rows {
            table.add(*line, &StringRecord::from(fields.to_vec())).unwrap();
        }
        table
    }

    #[test]
    fn rows_keep_their_lines() {
        let table = table(&[(2, &["0"]), (3, &["1"]), (7, &["2"]), (8, &["3"])]);
        assert_eq!([0, 1, 2, 3].map(|row| table.line(row)), [2, 3, 7, 8]);
    }

    #[test]
    fn fields_beyond_the_columns_are_found_unless_they_are_empty() {
        assert!(table(&[(1, &["0", "1", "", ""])]).surplus().is_none());
        let table = table(&[(1, &["0", "1"]), (2, &["0", "1", "", "5", ""]), (3, &["0", "1", "2"])]);
        let surplus = table.surplus().unwrap();
        assert_eq!((surplus.row, surplus.found.as_str()), (1, "4 fields"));
    }

    #[test]
    fn strict_reading_refuses_the_first_missing_value_or_text() {
        let flaw = |rows: &[(u64, &[&str])], strict| {
            table(rows).values(1, strict).map(|values| values.len()).map_err(|f| (f.row, f.found))
        };
        let rows: &[(u64, &[&str])] = &[(1, &["0", "1"]), (2, &["1"]), (3, &["2", ""])];
        assert_eq!(flaw(rows, false), Ok(3));
        assert_eq!(flaw(rows, true), Err((1, "only 1 fields".into())));
        let rows: &[(u64, &[&str])] = &[(1, &["0", "nan"]), (2, &["1", "x"]), (3, &["2", "y"])];
        assert_eq!(flaw(rows, false), Err((1, "`x`".into())));
        assert_eq!(flaw(rows, true), Err((0, "`nan`".into())));
    }

    #[test]
    fn rows_and_values_are_limited() {
        let row = StringRecord::from(vec!["0", "1"]);
        let mut table = table(&[]);
        table.max_rows = 2;
        assert!(table.add(1, &row).and_then(|()| table.add(2, &row)).is_ok());
        assert_eq!(table.add(3, &row).unwrap_err().0, "more than 2 rows");
        table.max_rows = MAX_ROWS;
        table.max_values = 8;
        assert!(table.add(4, &row).is_ok());
        assert_eq!(table.add(5, &row).unwrap_err().0, "more than 8 values");
        assert!(Table::new(MAX_NAMES + 1, false, 0).is_err());
    }
}
