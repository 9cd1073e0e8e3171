//! Header and units of a sheet: the rows above its data.
//!
//! The data begin at the first row in which at least half of the used columns have a number or a
//! date, and the next row too. Rows with numbers directly above belong to the data. The row of
//! texts above the data names the columns. It contains the units if it looks like units and the row
//! directly above it has a text for each of them. Other rows above are titles.

use super::field::Field;
use crate::log::files::text::number::is_units;

/// Row from 0, and its cells.
pub(super) type Row = (u32, Vec<Field>);

/// Rows above the data.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Head {
    /// Names of the columns; empty without a header.
    pub(super) names: Vec<String>,
    pub(super) units: Vec<String>,
    /// Number of rows above the data, among those that are not empty.
    pub(super) rows: usize,
}

impl Head {
    /// Finds the header in the first rows of a sheet that are not empty.
    pub(super) fn find(rows: &[Row]) -> Self {
        let Some(data) = first_data(rows) else {
            // A sheet of texts.
            return Self { names: rows.first().map(texts).unwrap_or_default(), rows: 1, ..Self::default() };
        };
        let (above, data_rows) = rows.split_at(data);
        match above {
            [.., names, units] if are_units(names, units) => {
                Self { names: texts(names), units: texts(units), rows: data }
            }
            [.., names] => Self { names: texts(names), rows: data, ..Self::default() },
            [] => match data_rows {
                // Numbers may be names of columns beside a text.
                [first, second, ..] if has_text_above_readings(first, second) => {
                    Self { names: texts(first), rows: 1, ..Self::default() }
                }
                _ => Self::default(),
            },
        }
    }
}

/// Index of the first row of data.
fn first_data(rows: &[Row]) -> Option<usize> {
    let width = rows.iter().map(|(_, row)| row.len()).max().unwrap_or(0);
    let is_used =
        |column: &usize| rows.iter().any(|(_, row)| row.get(*column).is_some_and(|f| !f.is_empty()));
    let used = (0..width).filter(is_used).count();
    let readings = |(_, row): &Row| row.iter().filter(|field| field.is_reading()).count();
    let is_full = |row: &Row| readings(row) > 0 && 2 * readings(row) >= used;
    let is_data =
        |index: usize| rows.get(index).is_some_and(is_full) && rows.get(index + 1).is_none_or(is_full);
    let mut first = (0..rows.len())
        .find(|index| is_data(*index))
        .or_else(|| rows.iter().position(|r| readings(r) > 0))?;
    while let Some(above) = first.checked_sub(1)
        && rows.get(above).is_some_and(|row| readings(row) > 0)
    {
        first = above;
    }
    // A row of units with the number 1 for a dimensionless column.
    let has_units = match rows.split_at_checked(first) {
        Some(([.., names], [units, next, ..])) => {
            are_units(names, units) && has_text_above_readings(units, next)
        }
        _ => false,
    };
    Some(first + usize::from(has_units))
}

/// Contents of a row.
fn texts((_, row): &Row) -> Vec<String> {
    row.iter().map(Field::text).collect()
}

/// Returns whether a row contains the units of the names in another one, directly above it.
fn are_units(names: &Row, units: &Row) -> bool {
    let is_named = |column: usize| names.1.get(column).is_some_and(|field| matches!(field, Field::Text(_)));
    let is_unit = |(column, field): (usize, &Field)| field.is_empty() || is_named(column);
    // A dimensionless column has the unit 1.
    let fields: Vec<String> = texts(units).into_iter().filter(|text| text != "1").collect();
    names.0.checked_add(1) == Some(units.0)
        && units.1.iter().enumerate().all(is_unit)
        && !names.1.iter().any(Field::is_reading)
        && is_units(&fields, false)
}

/// Returns whether a row has a text in a column in which the next one has a number.
fn has_text_above_readings((_, first): &Row, (_, second): &Row) -> bool {
    let mut pairs = first.iter().zip(second);
    pairs.any(|(above, below)| matches!(above, Field::Text(_)) && !above.is_reading() && below.is_reading())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of a table: lines, and cells divided by blanks, `-` for an empty one.
    fn rows(table: &str) -> Vec<Row> {
        let field = |text: &str| match text.parse() {
            Ok(value) => Field::Number(value),
            Err(_) if text == "-" => Field::Empty,
            Err(_) => Field::Text(text.into()),
        };
        let row = |line: &str| line.split_whitespace().map(field).collect();
        let rows = table.lines().enumerate().map(|(at, line)| (at as u32, row(line)));
        rows.filter(|(_, row): &Row| !row.is_empty()).collect()
    }

    #[test]
    fn titles_names_units_and_data_are_distinguished() {
        for (table, names, units, above) in [
            ("t F\n0 1\n1 2", "t F", "", 1),
            ("t F\ns N\n0 1\n1 2", "t F", "s N", 2),
            ("Log\n\nt F a\ns N rad\n0 1 2\n1 2 3", "t F a", "s N rad", 3),
            ("Log\nt F\n0 1\n1 2", "t F", "", 2),
            // A date or a number beside a title.
            ("Rate 100\nt F\n0 1\n1 2", "t F", "", 2),
            ("t F a\nZeit Kraft Winkel\ns N rad\n0 1 2\n1 2 3", "Zeit Kraft Winkel", "s N rad", 3),
            ("range - F\nt t2 F\n0 1 2\n1 2 3", "t t2 F", "", 2),
            ("0 1\n1 2", "", "", 0),
            ("t 1 2\n0 1 2\n1 2 3", "t 1 2", "", 1),
            // Rows with few numbers are data.
            ("t a b c d\n0 1\n1 2\n2 3 4 5 6\n3 4 5 6 7", "t a b c d", "", 1),
            ("t a b\n0 start x\n1 2 3\n2 3 4", "t a b", "", 1),
            ("t mu\ns 1\n0 1\n1 2", "t mu", "s 1", 2),
            ("name v\na 1\na 2", "name v", "", 1),
            ("name v\na b", "name v", "", 1),
            ("t a b c d\n0\n1\n2 1", "t a b c d", "", 1),
        ] {
            let words = |text: &str| text.split_whitespace().map(|w| w.replace('-', "")).collect::<Vec<_>>();
            let head = Head { names: words(names), units: words(units), rows: above };
            assert_eq!(Head::find(&rows(table)), head, "{table}");
        }
    }

    #[test]
    fn the_unit_1_is_a_unit() {
        let text = |row: [&str; 2]| row.map(|t| Field::Text(t.into())).to_vec();
        let numbers = |value: f64| vec![Field::Number(value), Field::Number(value)];
        let rows = [(0, text(["t", "mu"])), (1, text(["s", "1"])), (2, numbers(0.0)), (3, numbers(1.0))];
        assert_eq!(Head::find(&rows).units, ["s", "1"]);
    }
}
