//! Numbers as loggers write them: with a decimal point or a decimal comma.

/// Entries that loggers write in place of a missing reading.
const MISSING: [&str; 8] = ["", "nan", "na", "n/a", "null", "none", "inf", "-inf"];

/// Content expected in place of a number with separators of thousands.
pub(in crate::log) const NO_THOUSANDS: &str = "a number without separators of thousands";

/// Parses a finite number. With `decimal_comma` the comma is the decimal sign, and a point is
/// refused: it could only separate thousands.
pub(in crate::log) fn parse(field: &str, decimal_comma: bool) -> Option<f64> {
    let number = match decimal_comma {
        // A comma at the end separates columns of another format.
        true if field.contains('.') || field.ends_with(',') => return None,
        true => field.replacen(',', ".", 1).parse::<f64>(),
        false => field.parse(),
    };
    number.ok().filter(|value| value.is_finite())
}

/// Returns whether a field stands for a missing reading.
pub(in crate::log) fn is_missing(field: &str) -> bool {
    MISSING.iter().any(|missing| field.eq_ignore_ascii_case(missing))
}

/// Returns whether a field is a number or a missing value. Thousands are refused when they are
/// read, with a message.
pub(in crate::log::files) fn is_value(field: &str, decimal_comma: bool) -> bool {
    parse(field, decimal_comma).is_some() || is_missing(field) || has_thousands(field, decimal_comma)
}

/// Returns whether a field is a number with separators of thousands: `1.234,5`, `1,234,567`. A
/// single group without a decimal part is none, because it may also be a decimal part: `1,234`.
pub(in crate::log) fn has_thousands(field: &str, decimal_comma: bool) -> bool {
    let (decimal, group) = if decimal_comma { (',', '.') } else { ('.', ',') };
    let is_digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    let (grouped, fraction) = match field.split_once(decimal) {
        Some((grouped, fraction)) => (grouped, Some(fraction)),
        None => (field, None),
    };
    let mut groups = grouped.trim_start_matches(['+', '-']).split(group);
    let is_first = groups.next().is_some_and(|first| (1..=3).contains(&first.len()) && is_digits(first));
    let mut others = groups.clone();
    let min_groups = if fraction.is_some() { 1 } else { 2 };
    is_first
        && fraction.is_none_or(is_digits)
        && groups.count() >= min_groups
        && others.all(|group| group.len() == 3 && is_digits(group))
}

/// Returns whether a line under the header contains units: text in some fields, a number in none.
pub(in crate::log) fn is_units(row: &[String], decimal_comma: bool) -> bool {
    let is_number = |field: &String| parse(field, decimal_comma).is_some();
    // A number in another form is no unit: `-1.234,5`.
    let is_other_number = |field: &String| {
        let digits = field.trim_start_matches(['+', '-', '.', ',']);
        digits.starts_with(|c: char| c.is_ascii_digit()) && !field.contains(|c: char| c.is_alphabetic())
    };
    let is_text = |field: &String| !is_missing(field) && !is_other_number(field);
    !row.iter().any(|field| is_number(field) || is_other_number(field)) && row.iter().any(is_text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimal_signs_and_thousands_are_distinguished() {
        for (field, decimal_comma, value, thousands) in [
            ("1.5", false, Some(1.5), false),
            ("1,5", true, Some(1.5), false),
            ("-1,5e-3", true, Some(-1.5e-3), false),
            ("12", true, Some(12.0), false),
            ("1,", true, None, false),
            ("1.234", true, None, false),
            ("1.234,5", true, None, true),
            ("-12.345.678", true, None, true),
            ("1,234.5", false, None, true),
            ("1,234", false, None, false),
            ("1,23.5", false, None, false),
            ("1,5,5", true, None, false),
            ("inf", false, None, false),
        ] {
            assert_eq!(parse(field, decimal_comma), value, "{field}");
            assert_eq!(has_thousands(field, decimal_comma), thousands, "{field}");
        }
    }

    #[test]
    fn a_line_of_units_has_text_and_no_number() {
        let row = |fields: &[&str]| fields.iter().map(|field| (*field).to_owned()).collect::<Vec<_>>();
        for units in [&["s", "N", "mm"][..], &["[s]", "", "1/min"], &["ms", "-"]] {
            assert!(is_units(&row(units), true), "{units:?}");
        }
        for other in
            [&["0", "N"][..], &["", "nan"], &["1.234,5", "2.000"], &["1,5", "x"], &["-1.234,5", "mm"]]
        {
            assert!(!is_units(&row(other), true), "{other:?}");
        }
    }
}
