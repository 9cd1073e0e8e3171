//! Lines of `[columns]` that correct a log.

use super::tuning;
use bench::Bench;
use bench::log::{Column, ColumnId};

/// The described column of a signal; by default the one with its name.
fn column(bench: &Bench, name: &str) -> Column {
    let own = Column { from: ColumnId::Name(name.into()), scale: 1.0, offset: 0.0 };
    bench.log_format().columns.get(name).cloned().unwrap_or(own)
}

/// A line of `[columns]`.
fn line(name: &str, column: &Column) -> String {
    let from = match &column.from {
        ColumnId::Index(index) => index.to_string(),
        ColumnId::Name(name) => format!("{name:?}"),
    };
    let mut line = format!("{name} = {{ from = {from}");
    if column.scale != 1.0 {
        line.push_str(&format!(", scale = {:?}", column.scale));
    }
    if column.offset != 0.0 {
        line.push_str(&format!(", offset = {:?}", column.offset));
    }
    line.push_str(" }");
    line
}

/// The line that multiplies a signal.
pub(super) fn scaled(bench: &Bench, name: &str, factor: f64) -> String {
    let mut own = column(bench, name);
    own.scale *= factor;
    // A user would write the rounded number.
    if (own.scale - own.scale.round()).abs() < tuning::SCALE_ROUNDING * own.scale.abs() {
        own.scale = own.scale.round();
    }
    own.offset *= factor;
    line(name, &own)
}

/// The line that takes a signal from the column of another one.
pub(super) fn taken(bench: &Bench, name: &str, other: &str, factor: f64) -> String {
    let mut own = column(bench, other);
    own.scale *= factor;
    own.offset *= factor;
    line(name, &own)
}
