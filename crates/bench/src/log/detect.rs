//! Detection of the format of a text log: separator, header, decimal comma.

use super::text::{MISSING, fields_of};
use crate::log::{Separator, TextFormat};

/// Lines that are examined.
const EXAMINED_LINES: usize = 40;
/// Share of the fields after the first line that must be numbers.
const MIN_NUMBER_SHARE: f64 = 0.8;

/// Detects the format of a text; `None` if no separator divides it into columns of numbers.
pub(super) fn detect(text: &str) -> Option<TextFormat> {
    let separators = [Separator::Comma, Separator::Semicolon, Separator::Tab, Separator::Whitespace];
    let candidates = separators.into_iter().flat_map(|separator| {
        let commas = if separator == Separator::Comma { &[false][..] } else { &[false, true] };
        commas.iter().filter_map(move |&decimal_comma| {
            let format = TextFormat { separator, header: false, decimal_comma };
            let share = number_share(text, &format)?;
            (share > MIN_NUMBER_SHARE).then_some((share, format))
        })
    });
    // Of equally good formats the first one counts: the project's own, if it is among them.
    let better = |best: (f64, TextFormat), next: (f64, TextFormat)| if next.0 > best.0 { next } else { best };
    let (_, format) = candidates.reduce(better)?;
    let first = lines(text).next()?;
    let is_header = fields_of(first, format.separator).any(|field| !is_value(field, format.decimal_comma));
    Some(TextFormat { header: is_header, ..format })
}

/// Share of numbers among the fields after the first line; `None` unless all lines have the same
/// number of fields, at least two.
fn number_share(text: &str, format: &TextFormat) -> Option<f64> {
    let rows: Vec<Vec<&str>> = lines(text).map(|line| fields_of(line, format.separator).collect()).collect();
    let count = rows.first()?.len();
    if count < 2 || rows.iter().any(|row| row.len() != count) {
        return None;
    }
    let fields = || rows.iter().skip(1).flatten();
    let numbers = fields().filter(|field| is_value(field, format.decimal_comma)).count();
    Some(numbers as f64 / fields().count().max(1) as f64)
}

/// Lines with content. The last one may be incomplete.
fn lines(text: &str) -> impl Iterator<Item = &str> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    text.lines().filter(|line| !line.trim().is_empty() && !line.starts_with('#')).take(EXAMINED_LINES)
}

/// Returns whether a field is a number or a missing value.
fn is_value(field: &str, decimal_comma: bool) -> bool {
    let is_missing = MISSING.iter().any(|missing| field.eq_ignore_ascii_case(missing));
    is_missing || super::text::parse(field, decimal_comma).is_some()
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
            ("# made by a logger\ntime (s),x\n0,1\n,2\n", Separator::Comma, true, false),
        ] {
            assert_eq!(detect(text), Some(TextFormat { separator, header, decimal_comma }), "{text}");
        }
        for text in ["", "one column\n1\n2\n", "a b\nfree text here\n"] {
            assert_eq!(detect(text), None, "{text}");
        }
    }
}
