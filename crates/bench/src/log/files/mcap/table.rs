//! Table of a topic: a row for each message, a column for each number.

use crate::log::files::file::{MAX_COLUMNS, MAX_NAMES, MAX_ROWS, MAX_VALUES};
use std::collections::{BTreeMap, HashMap};

/// Maximum length of a column's name, with its topic.
const MAX_NAME_BYTES: usize = 1000;
/// Paths of the time of a reading.
const STAMPS: [&str; 3] = [".header.stamp", ".stamp", ".timestamp"];
const NS_PER_S: f64 = 1e9;
pub(super) const TEXTS: &str = "texts";
pub(super) const LONG_ARRAY: &str = "an array of more than 1000 elements";
const _: () = assert!(MAX_COLUMNS == 1000);

/// Reason to stop reading.
#[derive(Debug, PartialEq)]
pub(super) enum Flaw {
    Damage(String),
    TooLarge,
}

impl From<&str> for Flaw {
    fn from(found: &str) -> Self {
        Self::Damage(found.into())
    }
}

impl From<String> for Flaw {
    fn from(found: String) -> Self {
        Self::Damage(found)
    }
}

/// Numbers and names that a file may still have.
pub(super) struct Budget {
    values: usize,
    names: usize,
}

impl Default for Budget {
    fn default() -> Self {
        Self { values: MAX_VALUES, names: MAX_NAMES }
    }
}

impl Budget {
    fn spend(left: &mut usize, count: usize) -> Result<(), Flaw> {
        *left = left.checked_sub(count).ok_or(Flaw::TooLarge)?;
        Ok(())
    }

    /// Accounts for a name.
    pub(super) fn name(&mut self) -> Result<(), Flaw> {
        Self::spend(&mut self.names, 1)
    }
}

/// Column of a topic.
struct Column {
    name: String,
    /// Values; rows at the end may be missing.
    values: Vec<f64>,
    /// True for times in ns since the first message of the file.
    is_time: bool,
}

/// Messages of a topic.
#[derive(Default)]
pub(super) struct Table {
    columns: Vec<Column>,
    /// Index of each column by its name.
    index: HashMap<String, usize>,
    /// Column that is expected next.
    next: usize,
    /// Time of recording of each row in ns.
    log_times: Vec<i64>,
    /// Times that the messages state in ns; fewer than rows if a message states none.
    stamps: Vec<i64>,
    /// Content that is no number, with the reason.
    others: BTreeMap<String, &'static str>,
}

/// Columns of a topic that have as many rows.
pub(super) struct Rows {
    /// Times in s.
    pub(super) times: Vec<f64>,
    /// Names, values, and true for a time in s.
    pub(super) columns: Vec<(String, Vec<f64>, bool)>,
    /// Names and reasons of other content.
    pub(super) others: BTreeMap<String, &'static str>,
}

impl Table {
    /// Adds the row of a message. The times are those of its recording and of the first message of
    /// the file, in ns.
    pub(super) fn row<'a>(
        &'a mut self,
        topic: &str,
        (log_time, first): (i64, i64),
        budget: &'a mut Budget,
    ) -> Result<Row<'a>, Flaw> {
        let row = self.log_times.len();
        if row >= MAX_ROWS {
            return Err(Flaw::TooLarge);
        }
        Budget::spend(&mut budget.values, self.columns.len() + 1)?;
        self.log_times.push(log_time);
        self.next = 0;
        Ok(Row { table: self, budget, row, first, topic_bytes: topic.len() })
    }

    /// Number of rows.
    pub(super) fn rows(&self) -> usize {
        self.log_times.len()
    }

    /// Times of the rows in ns: those that the messages state if all do, else those of recording.
    pub(super) fn times(&self) -> &[i64] {
        let is_stamped = self.stamps.len() == self.log_times.len() && !self.stamps.contains(&0);
        if is_stamped { &self.stamps } else { &self.log_times }
    }

    /// Completes the columns, in the order of recording. Times are in s since an origin.
    pub(super) fn finish(self, origin: i64, first: i64) -> Rows {
        let rows = self.log_times.len();
        let seconds = |time: &i64| time.saturating_sub(origin) as f64 / NS_PER_S;
        let mut times: Vec<f64> = self.times().iter().map(seconds).collect();
        let shift = first.saturating_sub(origin) as f64;
        let long = |(path, reason): (&String, &&str)| (*reason == LONG_ARRAY).then(|| format!("{path}["));
        let long: Vec<String> = self.others.iter().filter_map(long).collect();
        let is_listed = |column: &Column| {
            long.is_empty() || {
                let path = general(&column.name);
                !long.iter().any(|array| path.starts_with(array))
            }
        };
        let mut columns = Vec::new();
        for Column { name, mut values, is_time } in self.columns.into_iter().filter(is_listed) {
            values.resize(rows, f64::NAN);
            if is_time {
                values.iter_mut().for_each(|value| *value = (*value + shift) / NS_PER_S);
            }
            columns.push((name, values, is_time));
        }
        if !self.log_times.is_sorted() {
            let mut order: Vec<usize> = (0..rows).collect();
            order.sort_by_key(|row| self.log_times.get(*row));
            let sorted = |values: &[f64]| order.iter().filter_map(|row| values.get(*row).copied()).collect();
            times = sorted(&times);
            columns.iter_mut().for_each(|(_, values, _)| *values = sorted(values));
        }
        Rows { times, columns, others: self.others }
    }
}

/// Row that is being filled.
pub(super) struct Row<'a> {
    table: &'a mut Table,
    budget: &'a mut Budget,
    /// Number of rows before.
    row: usize,
    /// Time of the first message of the file in ns.
    first: i64,
    /// Length of the topic, with which all paths begin.
    topic_bytes: usize,
}

impl Row<'_> {
    /// Adds a number. Of two numbers with one path the first one counts.
    pub(super) fn number(&mut self, path: &str, value: f64) -> Result<(), Flaw> {
        self.put(path, value, false)
    }

    /// Adds a duration in ns.
    pub(super) fn duration(&mut self, path: &str, duration: i64) -> Result<(), Flaw> {
        self.put(path, duration as f64 / NS_PER_S, false)
    }

    /// Adds a time in ns: the one of the row, or a column, where zero is a missing value.
    pub(super) fn time(&mut self, path: &str, time: i64) -> Result<(), Flaw> {
        if !self.is_stamp(path) {
            if time == 0 {
                return Ok(());
            }
            return self.put(path, time.saturating_sub(self.first) as f64, true);
        }
        if self.table.stamps.len() == self.row {
            self.table.stamps.push(time);
        }
        Ok(())
    }

    /// Returns whether a path is that of the time of the row.
    pub(super) fn is_stamp(&self, path: &str) -> bool {
        path.get(self.topic_bytes..).is_some_and(|field| STAMPS.contains(&field))
    }

    /// Adds the name of content that is no number.
    pub(super) fn other(&mut self, path: &str, reason: &'static str) -> Result<(), Flaw> {
        let path = general(path);
        if !self.table.others.contains_key(&path) {
            self.budget.name()?;
            self.table.others.insert(path, reason);
        }
        Ok(())
    }

    fn put(&mut self, path: &str, value: f64, is_time: bool) -> Result<(), Flaw> {
        let expected = self.table.next;
        let index = match self.table.columns.get(expected) {
            Some(column) if column.name == path => expected,
            _ => match self.table.index.get(path) {
                Some(index) => *index,
                None => self.add(path, is_time)?,
            },
        };
        self.table.next = index + 1;
        if let Some(Column { values, .. }) = self.table.columns.get_mut(index)
            && values.len() <= self.row
        {
            values.resize(self.row, f64::NAN);
            values.push(value);
        }
        Ok(())
    }

    /// Adds a column and returns its index.
    fn add(&mut self, path: &str, is_time: bool) -> Result<usize, Flaw> {
        if path.len() > MAX_NAME_BYTES {
            return Err(format!("a field with a name of more than {MAX_NAME_BYTES} bytes").into());
        }
        self.budget.name()?;
        Budget::spend(&mut self.budget.values, self.row + 1)?;
        let index = self.table.columns.len();
        self.table.index.insert(path.to_owned(), index);
        self.table.columns.push(Column { name: path.to_owned(), values: Vec::new(), is_time });
        Ok(index)
    }
}

/// Path without the indices of its arrays.
fn general(path: &str) -> String {
    let mut out = String::new();
    for part in path.split_inclusive('[') {
        let rest = part.split_once(']').filter(|_| out.ends_with('['));
        match rest {
            Some((_, rest)) => {
                out.push(']');
                out.push_str(rest);
            }
            None => out.push_str(part),
        }
    }
    out
}
