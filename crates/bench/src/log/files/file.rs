//! Open file of a log, and columns to write: named columns of numbers, whatever the format.

use crate::log::{LogError, TextFormat};
use std::cell::Cell;
use std::collections::{HashMap, HashSet};
use std::fmt::Display;
use std::panic;
use std::sync::Once;

/// Maximum number of rows of a log; bounds memory on hostile input.
pub(in crate::log) const MAX_ROWS: usize = 20_000_000;
/// Maximum number of values that a file of a compressed format may unpack to: a small file of
/// zeros could otherwise fill any memory.
pub(in crate::log) const MAX_VALUES: usize = 10 * MAX_ROWS;
/// Maximum number of columns of a file, and of other content that has a name.
pub(super) const MAX_NAMES: usize = 100_000;
/// Maximum number of listed columns of a matrix.
pub(super) const MAX_COLUMNS: usize = 1000;

/// Column of a log that is written.
#[derive(Clone, Copy, Debug)]
pub(in crate::log) struct Written<'a> {
    pub(in crate::log) name: &'a str,
    /// Unit; empty for none.
    pub(in crate::log) unit: &'a str,
    /// Values, NaN where missing; all columns have as many.
    pub(in crate::log) values: &'a [f64],
}

/// Open file of a log, split into columns. Columns may have different lengths.
pub(in crate::log) trait LogFile {
    /// Format in words.
    fn format(&self) -> &'static str;

    /// Names of the columns; empty for a text without a header.
    fn names(&self) -> &[String];

    /// Values of a column, NaN where missing; `wanted` names it in messages.
    ///
    /// # Errors
    ///
    /// The column has no numbers or is damaged.
    fn values(&self, file: &str, index: usize, wanted: &str, is_strict: bool) -> Result<Vec<f64>, LogError>;

    /// Unit of a column; empty if the file has none.
    fn unit(&self, _index: usize) -> &str {
        ""
    }

    /// Group of a column; empty without groups.
    fn group(&self, _index: usize) -> &str {
        ""
    }

    /// Column with the times of a column, its own for times; `None` if the file does not state it.
    fn time_of(&self, _index: usize) -> Option<usize> {
        None
    }

    /// Number of columns.
    fn width(&self) -> usize {
        self.names().len()
    }

    /// Text format as detected; the default for a binary file, whose columns have names.
    fn detected(&self) -> Option<TextFormat> {
        Some(TextFormat::default())
    }

    /// Clause about the text format that the file seems to have, if it is read in another one.
    fn hint(&self) -> String {
        String::new()
    }

    /// Place where a name of a column is expected.
    fn expected_name(&self, name: &str) -> String {
        format!("a column `{name}`")
    }

    /// Describes a row as a reader of the file would count it.
    fn place(&self, row: usize) -> String {
        format!("row {}", row + 1)
    }
}

/// Names of the columns for a message.
pub(in crate::log) fn list(file: &dyn LogFile) -> String {
    if file.names().is_empty() {
        return format!("{} columns without a header", file.width());
    }
    format!("`{}`", file.names().join("`, `"))
}

/// Returns the error of a column that a signal asks for.
pub(super) fn refused(
    file: &str,
    (name, wanted): (&str, &str),
    found: impl Display,
    expected: &str,
) -> LogError {
    LogError::content(file, format!("column `{name}` for {wanted}: {found}"), expected)
}

/// Names for columns of several groups: the own name of a column if it occurs once in the file,
/// else `GROUP/NAME`; within a group a repeated name has its number, `GROUP/NAME#2`.
pub(super) fn unique_names(columns: &[(String, String)]) -> Vec<String> {
    let mut own: HashMap<&str, usize> = HashMap::new();
    columns.iter().for_each(|(_, name)| *own.entry(name).or_default() += 1);
    let mut seen: HashMap<(String, String), usize> = HashMap::new();
    let mut unique = |(group, name): &'_ (String, String)| {
        if own.get(name.as_str()) == Some(&1) {
            return name.clone();
        }
        let count = seen.entry((group.clone(), name.clone())).or_default();
        *count += 1;
        if *count == 1 { format!("{group}/{name}") } else { format!("{group}/{name}#{count}") }
    };
    distinct(columns.iter().map(&mut unique).collect())
}

/// Names of which none repeats another one: a name that is taken has a number after it.
pub(super) fn distinct(names: Vec<String>) -> Vec<String> {
    let mut taken: HashSet<String> = HashSet::new();
    // Last number of each name, so that many equal names do not cost the square of their count.
    let mut numbers: HashMap<String, usize> = HashMap::new();
    let free = |name: String| {
        let mut found = name.clone();
        while !taken.insert(found.clone()) {
            let number = numbers.entry(name.clone()).or_insert(1);
            *number += 1;
            found = format!("{name}#{number}");
        }
        found
    };
    names.into_iter().map(free).collect()
}

thread_local! {
    /// True while a library reads a file in this thread.
    static IS_GUARDED: Cell<bool> = const { Cell::new(false) };
}

/// Runs a library and turns its panic on a damaged file into an ordinary error, without the message
/// of the panic.
pub(super) fn guarded<T, E: Display>(read: impl FnOnce() -> Result<T, E>) -> Result<T, String> {
    static QUIET: Once = Once::new();
    QUIET.call_once(|| {
        let usual = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if !IS_GUARDED.get() {
                usual(info);
            }
        }));
    });
    let before = IS_GUARDED.replace(true);
    let result = panic::catch_unwind(panic::AssertUnwindSafe(read));
    IS_GUARDED.set(before);
    result.map_or_else(|_| Err("a damaged file".into()), |found| found.map_err(|e| e.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_has_its_own_name_unless_another_group_has_it_too() {
        let columns = [("a", "time"), ("a", "angle"), ("b", "time"), ("b", "force"), ("b", "time")]
            .map(|(group, name)| (group.to_owned(), name.to_owned()));
        assert_eq!(unique_names(&columns), ["a/time", "angle", "b/time", "force", "b/time#2"]);
    }

    #[test]
    fn no_two_columns_have_one_name() {
        let columns =
            [("a", "x"), ("b", "x"), ("c", "a/x"), ("c", "a/x#2")].map(|(g, n)| (g.to_owned(), n.to_owned()));
        assert_eq!(unique_names(&columns), ["a/x", "b/x", "a/x#2", "a/x#2#2"]);
    }
}
