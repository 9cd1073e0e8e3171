//! Writing of a log: CSV text, Parquet or a MAT-file.

use super::file::Written;
use super::text::number::{is_units, is_value};
use super::text::records::MARK;
use super::{mat_write, parquet};
use crate::log::LogError;
use std::path::Path;

/// Returns the content of a file: Parquet for `.parquet`, a MAT-file for `.mat`, else CSV.
pub(in crate::log) fn bytes(file: &str, columns: &[Written<'_>]) -> Result<Vec<u8>, LogError> {
    let failed = |error: &dyn std::fmt::Display| LogError::Io {
        file: file.to_owned(),
        source: std::io::Error::other(error.to_string()),
    };
    match Kind::from_path(Path::new(file)) {
        Kind::Parquet => parquet::bytes(columns).map_err(|e| failed(&e)),
        Kind::Mat => mat_write::bytes(file, columns),
        Kind::Text => Ok(csv(columns)),
    }
}

/// Format of a file that is written.
#[derive(PartialEq)]
enum Kind {
    Text,
    Parquet,
    Mat,
}

impl Kind {
    fn from_path(path: &Path) -> Self {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
        match ending.as_deref() {
            Some("parquet") => Self::Parquet,
            Some("mat") => Self::Mat,
            _ => Self::Text,
        }
    }
}

/// Returns whether a file is written as text.
pub(in crate::log) fn is_text(path: &Path) -> bool {
    Kind::from_path(path) == Kind::Text
}

/// Returns CSV text: names, units if there are any, and shortest numbers that read back exactly.
///
/// A column without a name is called `column_0` by its place, and a dimensionless one has an empty
/// unit. A header that looks like numbers is quoted with a mark, by which it is recognised.
fn csv(columns: &[Written<'_>]) -> Vec<u8> {
    let name = |(place, column): (usize, &Written<'_>)| match column.name.trim() {
        "" => format!("column_{place}"),
        name => name.to_owned(),
    };
    let unit = |column: &Written<'_>| column.unit.trim().replace(['\r', '\n'], " ");
    let names: Vec<String> = columns.iter().enumerate().map(name).collect();
    let units = columns.iter().map(unit).map(|unit| if unit == "1" { String::new() } else { unit });
    let units: Vec<String> = units.collect();
    let has_units = units.iter().any(|unit| !unit.is_empty());
    let is_marked = names.iter().all(|name| is_value(name, false)) || has_units && !is_units(&units, false);
    let field = |text: &String| field(text, is_marked);
    let mut out = names.iter().map(field).collect::<Vec<_>>().join(",") + "\n";
    if has_units {
        out += &(units.iter().map(field).collect::<Vec<_>>().join(",") + "\n");
    }
    let rows = columns.first().map_or(0, |column| column.values.len());
    // The line of a single missing value would be empty, and skipped.
    let missing = if columns.len() == 1 { "nan" } else { "" };
    for row in 0..rows {
        for (place, column) in columns.iter().enumerate() {
            out += if place == 0 { "" } else { "," };
            match column.values.get(row).filter(|value| !value.is_nan()) {
                Some(value) => out += &format!("{value:?}"),
                None => out += missing,
            }
        }
        out.push('\n');
    }
    out.into_bytes()
}

/// Field of a header: quoted if it would be read as a comment, as a separator or as several fields.
fn field(text: &str, is_marked: bool) -> String {
    let is_special = text.contains([',', ';', '\t', '"', '\r', '\n'])
        || text.starts_with(['#', '%', '\u{feff}'])
        || text.starts_with("sep=");
    match is_marked || is_special {
        true => format!("{}{}\"", if is_marked { MARK } else { "\"" }, text.replace('"', "\"\"")),
        false => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::RawLog;
    use proptest::prelude::*;

    fn text(columns: &[(String, String, Vec<f64>)]) -> String {
        let written = columns.iter().map(|(name, unit, values)| Written { name, unit, values });
        String::from_utf8(csv(&written.collect::<Vec<_>>())).unwrap()
    }

    /// Two columns of two values.
    fn pair(names: [&str; 2], units: [&str; 2]) -> String {
        let column = |place: usize| (names[place].into(), units[place].into(), vec![place as f64, 2.5]);
        text(&[column(0), column(1)])
    }

    #[test]
    fn a_header_is_quoted_only_where_it_could_be_misread() {
        for (names, units, expected) in [
            (["t", "x y"], ["s", "m/s^2"], "t,x y\ns,m/s^2\n"),
            (["t", "x"], ["", "1"], "t,x\n"),
            (["t", "mu"], ["s", "1"], "t,mu\ns,\n"),
            (["%t", "#1"], ["%", "%"], "\"%t\",\"#1\"\n\"%\",\"%\"\n"),
            (["a,b", "c\"d"], ["", ""], "\"a,b\",\"c\"\"d\"\n"),
            (["", " "], ["", ""], "column_0,column_1\n"),
            (["1", "2"], ["", ""], "\" 1\",\" 2\"\n"),
            (["t", "x"], ["12", "N"], "\" t\",\" x\"\n\" 12\",\" N\"\n"),
        ] {
            assert_eq!(pair(names, units), format!("{expected}0.0,1.0\n2.5,2.5\n"));
        }
    }

    /// Names and units with everything that has a meaning in CSV.
    fn label() -> impl Strategy<Value = String> {
        let special =
            prop::sample::select(vec!["", "1", "nan", "-", "%", "#", "sep=;", "0", "5%", "\"", "1,5"]);
        prop_oneof!["[a-zA-Z0-9%#\",;. \t=/-]{0,6}", "[a-z]{1,3}", special.prop_map(String::from)]
    }

    /// Columns of one length, each with at least one number.
    fn columns() -> impl Strategy<Value = Vec<(String, String, Vec<f64>)>> {
        let value = prop_oneof![prop::num::f64::NORMAL | prop::num::f64::ZERO, Just(f64::NAN)];
        let column = move |rows: usize| {
            let values = (prop::num::f64::NORMAL, prop::collection::vec(value.clone(), rows));
            let values = values.prop_map(|(first, rest)| [rest, vec![first]].concat());
            (label(), label(), values)
        };
        (1..6_usize).prop_flat_map(move |rows| prop::collection::vec(column(rows), 1..5))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]
        #[test]
        fn a_written_text_is_read_back_with_names_units_and_values(columns in columns()) {
            let text = text(&columns);
            let log = RawLog::from_bytes("a.csv", text.clone().into_bytes());
            let log = log.map_err(|error| TestCaseError::fail(format!("{error}\n{text}")))?;
            prop_assert_eq!(log.columns.len(), columns.len(), "{}", text);
            for (place, (found, (name, unit, values))) in log.columns.iter().zip(&columns).enumerate() {
                let name = match name.trim() {
                    "" => format!("column_{place}"),
                    name => name.into(),
                };
                prop_assert_eq!(&found.name, &name, "{}", text);
                let unit = if unit.trim() == "1" { "" } else { unit.trim() };
                prop_assert_eq!(&found.unit, unit, "{}", text);
                let bits = |values: &[f64]| {
                    let bits = values.iter().map(|v| if v.is_nan() { None } else { Some(v.to_bits()) });
                    bits.collect::<Vec<_>>()
                };
                prop_assert_eq!(bits(&found.values), bits(values), "{}", text);
            }
        }
    }
}
