//! Comparison of the collision network's targets, as the example `companding` prints it: mean
//! absolute errors in N by force band for the plain force and for its companded forms.
//!
//! The file is the example's output: a title line, then one table with a header.

use crate::data::file_io::FileError;
use serde::Serialize;
use std::path::Path;

/// A comparison as a table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Comparison {
    /// Bearing, epochs, rows, unit.
    pub title: String,
    /// Header cells.
    pub header: Vec<String>,
    /// One row for each target.
    pub rows: Vec<Vec<String>>,
}

/// Cells of a table line; None if the line is not part of a table.
fn cells(line: &str) -> Option<Vec<String>> {
    let inner = line.trim().strip_prefix('|')?.strip_suffix('|')?;
    Some(inner.split('|').map(|cell| cell.trim().to_owned()).collect())
}

impl Comparison {
    /// Reads the example's output.
    ///
    /// # Errors
    ///
    /// The file cannot be read or has other content.
    pub(crate) fn read(path: &Path) -> Result<Self, FileError> {
        let text = FileError::text(path)?;
        let refused =
            |found: String| FileError::content(path, found, "the output of the example `companding`");
        let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
        let title = lines.next().map(|(_, line)| line.to_owned()).ok_or_else(|| refused("nothing".into()))?;
        let mut table = Vec::new();
        for (number, line) in lines {
            let row = cells(line).ok_or_else(|| refused(format!("no table in line {}", number + 1)))?;
            let width = table.first().map_or(row.len(), Vec::len);
            if row.len() != width {
                let found = format!("{} cells in line {} after {width}", row.len(), number + 1);
                return Err(refused(found));
            }
            table.push(row);
        }
        let mut table = table.into_iter();
        let (Some(header), Some(_rule)) = (table.next(), table.next()) else {
            return Err(refused("no table".into()));
        };
        let rows: Vec<Vec<String>> = table.collect();
        if rows.is_empty() {
            Err(refused("a table without rows".into()))
        } else {
            Ok(Self { title, header, rows })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Comparison, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("companding.txt");
        std::fs::write(&path, text).unwrap();
        Comparison::read(&path).map_err(|error| error.to_string())
    }

    #[test]
    fn the_output_of_the_example_is_read_and_other_content_refused_by_line() {
        let found = read("plastic, 2 epochs\n| target | to 1 kN |\n|---|---|\n| force | 3.5 |\n").unwrap();
        assert_eq!((found.title.as_str(), found.header[1].as_str()), ("plastic, 2 epochs", "to 1 kN"));
        assert_eq!(found.rows, [["force", "3.5"]]);
        for (text, expected) in [
            ("", "found nothing"),
            ("a\nb\n", "no table in line 2"),
            ("a\n| b |\n|---|\n", "without rows"),
            ("a\n| b |\n|---|\n| 1 | 2 |\n", "2 cells in line 4 after 1"),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.contains(expected) && error.contains("companding.txt"), "{error}");
        }
    }
}
