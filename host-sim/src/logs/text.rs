//! Text of a log's content for the terminal.

use super::{ColumnInfo, LogInfo, TimeInfo};
use diagnosis::four_digits;
use report::text_table;
use std::fmt::Write as _;

/// Maximum number of other contents that are listed.
const MAX_OTHERS: usize = 20;
/// Place of the group in a row, after the other texts.
const GROUP: usize = 3;

/// Formats the content of a log.
pub(crate) fn text(info: &LogInfo) -> String {
    let mut out = format!("{}: {}, {} columns of numbers\n", info.log, info.format, info.columns.len());
    let has_groups = info.columns.iter().any(|column| !column.group.is_empty());
    let mut header = vec!["index", "column", "unit", "rows", "missing", "smallest", "largest"];
    if has_groups {
        header.insert(GROUP, "group");
    }
    let rows = info.columns.iter().map(|column| row(column, has_groups));
    let _ = write!(out, "\n{}\n", text_table(header, rows, GROUP + usize::from(has_groups)));
    match &info.time {
        Some(time) => push_time(&mut out, time),
        None => out.push_str("\ntime: no column has the name or the unit of a time\n"),
    }
    if !info.others.is_empty() {
        out.push_str("\nno columns of numbers:\n");
    }
    for other in info.others.iter().take(MAX_OTHERS) {
        let _ = writeln!(out, "  {}: {}", other.name, other.reason);
    }
    if info.others.len() > MAX_OTHERS {
        let _ = writeln!(out, "  and {} more", info.others.len() - MAX_OTHERS);
    }
    out
}

fn row(column: &ColumnInfo, has_groups: bool) -> Vec<String> {
    let mut cells = vec![
        column.index.to_string(),
        column.name.clone(),
        column.unit.clone(),
        column.rows.to_string(),
        column.missing.to_string(),
        four_digits(column.min),
        four_digits(column.max),
    ];
    if has_groups {
        cells.insert(GROUP, column.group.clone());
    }
    cells
}

fn push_time(out: &mut String, time: &TimeInfo) {
    let unit = if time.in_seconds { " s" } else { " in its own unit" };
    let rate = match time.in_seconds && time.interval > 0.0 {
        true => format!(" ({} per second)", four_digits(1.0 / time.interval)),
        false => String::new(),
    };
    let _ = writeln!(
        out,
        "\ntime: `{}` over {}{unit}, interval {}{rate}, largest interval {}",
        time.name,
        four_digits(time.duration),
        four_digits(time.interval),
        four_digits(time.largest_interval)
    );
    if let Some(first) = time.first_not_ascending {
        let _ = writeln!(out, "  {} times do not ascend, first in row {first}", time.not_ascending);
    }
}
