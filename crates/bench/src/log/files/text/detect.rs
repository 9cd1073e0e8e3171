//! Detection of the format of a text log: separator, header, decimal comma.
//!
//! The first lines are divided with each separator, as reading does. The format with the largest
//! share of numbers counts; of equally good ones the first in the order comma, semicolon, tab,
//! whitespace, and a decimal point before a decimal comma. So `1,2,3` is separated by commas, and
//! `1,5;2,5` has decimal commas. A text that no separator divides may be one column of numbers.

use super::number::{is_units, is_value};
use super::records::{fields, for_each_row, marked_lines, without_comments};
use crate::log::{Separator, TextFormat};

/// Lines that are examined.
pub(super) const EXAMINED_LINES: usize = 1000;
/// Share of the fields after the header that must be numbers.
const MIN_NUMBER_SHARE: f64 = 0.8;

/// Detects the format of a text; `None` if no separator divides it into columns of numbers.
pub(super) fn detect(text: &str) -> Option<TextFormat> {
    let end = text.match_indices('\n').nth(EXAMINED_LINES).map_or(text.len(), |(end, _)| end);
    let examined = without_comments(text.get(..end)?);
    let marked = marked_lines(&examined);
    let separators = [Separator::Comma, Separator::Semicolon, Separator::Tab, Separator::Whitespace];
    let candidates = separators.into_iter().flat_map(|separator| {
        let rows = split(&examined, separator);
        let commas = if separator == Separator::Comma { &[false][..] } else { &[false, true] };
        let candidate = |&decimal_comma: &bool| {
            let (width, share, header) = Body::new(&rows, marked, decimal_comma)?.quality()?;
            let format = TextFormat { separator, header: header || marked > 0, decimal_comma };
            let is_possible = width > 1 || separator == Separator::Comma;
            (is_possible && share >= MIN_NUMBER_SHARE).then_some((width > 1, share, format))
        };
        commas.iter().filter_map(candidate).collect::<Vec<_>>()
    });
    let is_better =
        |next: &(bool, f64, TextFormat), best: &(bool, f64, TextFormat)| (next.0, next.1) > (best.0, best.1);
    Some(candidates.reduce(|best, next| if is_better(&next, &best) { next } else { best })?.2)
}

/// Rows of a text; none if it cannot be split.
fn split(text: &str, separator: Separator) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    let add = |_, row: &csv::StringRecord| {
        rows.push(fields(row));
        Ok(())
    };
    match for_each_row(text, separator, add) {
        Ok(()) => rows,
        Err(_) => Vec::new(),
    }
}

/// Rows as a format divides them.
struct Body<'a> {
    first: &'a [String],
    /// Rows after the first one and after the units.
    rows: &'a [Vec<String>],
    decimal_comma: bool,
}

impl<'a> Body<'a> {
    fn new(rows: &'a [Vec<String>], marked: usize, decimal_comma: bool) -> Option<Self> {
        let (first, mut rows) = rows.split_first()?;
        if let Some((units, after)) = rows.split_first()
            && (is_units(units, decimal_comma) || marked == 2)
        {
            rows = after;
        }
        Some(Self { first, rows, decimal_comma })
    }

    /// Number of columns, share of numbers among the fields, and presence of a header: a first row
    /// with text in a column of numbers. `None` without rows.
    fn quality(&self) -> Option<(usize, f64, bool)> {
        let count = self.first.len();
        if count == 0 || self.rows.is_empty() {
            return None;
        }
        // A row of another length has no number in its place.
        let is_fit = |row: &&Vec<String>| row.len() == count;
        let numbers_of = |column: usize| {
            let fields = self.rows.iter().filter(is_fit).filter_map(|row| row.get(column));
            fields.filter(|field| is_value(field, self.decimal_comma)).count()
        };
        let numbers: Vec<usize> = (0..count).map(numbers_of).collect();
        let is_text =
            |(field, numbers): (&String, &usize)| !is_value(field, self.decimal_comma) && *numbers > 0;
        let header = self.first.iter().zip(&numbers).any(is_text) || self.counts_columns();
        let total = numbers.iter().sum::<usize>() as f64;
        Some((count, total / (count * self.rows.len()) as f64, header))
    }

    /// Returns whether the first row numbers the columns from 0, as data frames without names are
    /// written: `0,1,2` or `,0,1`. A first sample of this form counts as a header too.
    fn counts_columns(&self) -> bool {
        let named = self.first.strip_prefix(&[String::new()]).unwrap_or(self.first);
        let min_columns = if named.len() == self.first.len() { 3 } else { 1 };
        named.len() >= min_columns
            && named.iter().enumerate().all(|(column, field)| *field == column.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn separator_header_and_decimal_comma_are_detected() {
        for (text, separator, header, decimal_comma) in [
            ("t_s,x\n0,1\n1,2\n", Separator::Comma, true, false),
            ("t_s, x\n0.5, 1e-3\n1, 2\n", Separator::Comma, true, false),
            ("t;x\n0,5;1,25\n1;2\n", Separator::Semicolon, true, true),
            ("t;x\n0.5;1.25\n1;2\n", Separator::Semicolon, true, false),
            ("t\tx\n0,5\t1,25\n1,0\t2,0\n", Separator::Tab, true, true),
            ("0.000\t3.416\t0.498\n10.000\t3.416\t0.499\n", Separator::Tab, false, false),
            ("  0.0  1.0\n  1.0   2.0\n", Separator::Whitespace, false, false),
            ("0,0 1,5\n1,0 2,5\n", Separator::Whitespace, false, true),
            ("# made by a logger\ntime (s),x\n0,1\n,2\n", Separator::Comma, true, false),
            ("% made by a logger\r\n\r\nt;x\r\n0,5;1\r\n1,5;2\r\n", Separator::Semicolon, true, true),
            ("t;x;F\ns;mm;N\n0,5;1;2\n1,5;2;3\n", Separator::Semicolon, true, true),
            ("\"t; s\";\"x\"\n\"0,5\";\"1,5\"\n1;2\n", Separator::Semicolon, true, true),
            // Integers separated by commas are no decimal commas.
            ("1,2,3\n4,5,6\n", Separator::Comma, false, false),
            ("1,2\n4,5\n", Separator::Comma, false, false),
            // Thousands are read, and refused, with decimal commas.
            ("t;x\n0,5;1.234,5\n1,5;2.345,6\n", Separator::Semicolon, true, true),
            // The first row is no header because of its text in a column of text.
            ("1,1,2,3,4,ok\n2,2,3,4,5,ok\n", Separator::Comma, false, false),
            // Numbers of columns are names.
            ("0,1,2\n0.01,0.5,20\n", Separator::Comma, true, false),
            (",0,1\n0,0.5,20\n", Separator::Comma, true, false),
            // A name may begin with a sign of comments.
            ("%time,x\n0,1\n1,2\n", Separator::Comma, true, false),
            ("sep=;\nt;x\n0;1\n1;2\n", Separator::Semicolon, true, false),
            ("\" 1\",\" 2\"\n0,1\n1,2\n", Separator::Comma, true, false),
            ("one column\n1\n2\n", Separator::Comma, true, false),
            ("1.5\n2.5\n", Separator::Comma, false, false),
        ] {
            assert_eq!(detect(text), Some(TextFormat { separator, header, decimal_comma }), "{text}");
        }
        for text in [
            "",
            "one column\na\nb\n",
            "a b\nfree text here\n",
            "t;x\n0,5;1.5\n1,5;2.5\n",
            "t_s, x\n0, 1,\n1, 2,\n",
        ] {
            assert_eq!(detect(text), None, "{text}");
        }
    }

    #[test]
    fn a_log_that_was_cut_off_is_detected() {
        let rows: String = (0..30).map(|i| format!("{i},5;{i};3\n")).collect();
        let format = TextFormat { separator: Separator::Semicolon, header: true, decimal_comma: true };
        assert_eq!(detect(&format!("t;x;y\n{rows}30,5;3")), Some(format));
    }
}
