//! Lines of `[columns]` that would mend a log.

use bench::Bench;
use bench::log_format::{Column, ColumnId};

fn column(bench: &Bench, name: &str) -> Column {
    let own = Column { from: ColumnId::Name(name.into()), scale: 1.0, offset: 0.0 };
    bench.log_format().columns.get(name).cloned().unwrap_or(own)
}

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
    // What is printed shall be what somebody would write.
    if (own.scale - own.scale.round()).abs() < 1e-12 * own.scale.abs() {
        own.scale = own.scale.round();
    }
    own.offset *= factor;
    line(name, &own)
}

/// The line that takes a signal from another one's column.
pub(super) fn taken(bench: &Bench, name: &str, other: &str, factor: f64) -> String {
    let mut own = column(bench, other);
    own.scale *= factor;
    own.offset *= factor;
    line(name, &own)
}
