//! Column of a sheet: numbers, or dates and times.

use super::field::{Field, cell_name};
use crate::log::files::text::number::parse;

const SECONDS_PER_DAY: f64 = 86_400.0;

/// Kind of the readings of a column.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Numbers,
    Dates,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Numbers => "a number",
            Self::Dates => "a date or time",
        }
    }
}

/// Column of a sheet.
#[derive(Debug, Default)]
pub(super) struct Column {
    pub(super) unit: String,
    /// Numbers, or days until [`Column::count_seconds`]; NaN where missing.
    pub(super) values: Vec<f64>,
    /// Reason why the column cannot be read.
    pub(super) flaw: Option<String>,
    kind: Option<Kind>,
    has_durations: bool,
}

impl Column {
    /// Returns a column that cannot be read.
    pub(super) fn refused(flaw: String) -> Self {
        Self { flaw: Some(flaw), ..Self::default() }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.values.is_empty() && self.flaw.is_none()
    }

    /// Adds a cell; `index` is the sample from 0, `place` the row and the column of the sheet.
    pub(super) fn add(&mut self, index: usize, place: (u32, usize), field: &Field) {
        if self.flaw.is_some() {
            return;
        }
        let cell = || cell_name(place.0, place.1);
        let (kind, value) = match field {
            Field::Empty => return,
            Field::Number(value) => (Kind::Numbers, *value),
            Field::Date(days) | Field::Duration(days) => (Kind::Dates, *days),
            Field::Text(text) => match parse(text, false) {
                Some(value) => (Kind::Numbers, value),
                None => return self.refuse(format!("`{text}` in cell {}", cell())),
            },
        };
        let known = *self.kind.get_or_insert(kind);
        if known != kind {
            let found = if kind == Kind::Dates { "" } else { " without the format of a date" };
            return self.refuse(format!("{}{found} in cell {} below {}", kind.name(), cell(), known.name()));
        }
        self.has_durations |= matches!(field, Field::Duration(_));
        self.values.resize(index, f64::NAN);
        self.values.push(value);
    }

    fn refuse(&mut self, flaw: String) {
        *self = Self { unit: std::mem::take(&mut self.unit), ..Self::refused(flaw) };
    }

    /// Earliest date; `None` for numbers, durations and times without a day.
    pub(super) fn first_date(&self) -> Option<f64> {
        let readings = self.values.iter().copied().filter(|days| days.is_finite());
        let first = readings.reduce(f64::min).filter(|_| self.kind == Some(Kind::Dates))?;
        (first >= 1.0 && !self.has_durations).then_some(first)
    }

    /// Converts dates into seconds since the earliest date of the workbook, times without a day
    /// into seconds since the first one of the column.
    pub(super) fn count_seconds(&mut self, earliest_date: Option<f64>) {
        if self.kind != Some(Kind::Dates) {
            return;
        }
        let own = self.values.iter().copied().find(|days| days.is_finite());
        let origin = self.first_date().and(earliest_date).or(own).unwrap_or(0.0);
        self.values.iter_mut().for_each(|value| *value = (*value - origin) * SECONDS_PER_DAY);
        "s".clone_into(&mut self.unit);
    }
}
