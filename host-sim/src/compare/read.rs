//! Stored runs: run.json and log.csv of their folders.

use crate::cli::error::CliError;
use serde_json::Value;
use std::path::Path;

/// Entries of run.json that are no results.
const NOT_COMPARED: [&str; 4] = ["provenance", "wall_s", "wall_s_per_simulated_s", "exchanges_per_s"];

/// Name of the column with the times.
const TIME: &str = "t_s";

/// Figures and log of a run.
#[derive(Clone, Debug)]
pub(crate) struct StoredRun {
    /// Numbers of run.json; the name of a nested one contains the names above it, with points.
    pub(super) figures: Vec<(String, f64)>,
    /// Times of the log, s, ascending.
    pub(super) times_s: Vec<f64>,
    /// Columns of the log; a missing value is not a number.
    pub(super) columns: Vec<(String, Vec<f64>)>,
}

impl StoredRun {
    pub(super) fn figure(&self, name: &str) -> Option<f64> {
        self.figures.iter().find(|figure| figure.0 == name).map(|figure| figure.1)
    }

    pub(super) fn column(&self, name: &str) -> Option<&[f64]> {
        self.columns.iter().find(|column| column.0 == name).map(|column| column.1.as_slice())
    }
}

/// Reads the folder of a run.
///
/// # Errors
///
/// A file is missing or is not what `host-sim run` writes.
pub(crate) fn read(folder: &Path) -> Result<StoredRun, CliError> {
    let figures = folder.join("run.json");
    let text = text(&figures)?;
    let value: Value = serde_json::from_str(&text).map_err(|e| wrong(&figures, &e))?;
    let mut numbers = Vec::new();
    collect(&mut numbers, "", &value);
    let (times_s, columns) = table(&folder.join("log.csv"))?;
    Ok(StoredRun { figures: numbers, times_s, columns })
}

fn text(path: &Path) -> Result<String, CliError> {
    std::fs::read_to_string(path).map_err(|error| {
        let expected = "expected the folder of a run";
        CliError::Input(format!("{}: cannot be read: {error}; {expected}", path.display()))
    })
}

fn wrong(path: &Path, error: &dyn std::fmt::Display) -> CliError {
    CliError::Input(format!("{}: {error}; expected a file of `host-sim run`", path.display()))
}

/// Collects the numbers of an object and of the objects in it. Lists belong to one run alone.
fn collect(numbers: &mut Vec<(String, f64)>, above: &str, value: &Value) {
    for (name, value) in value.as_object().into_iter().flatten() {
        if NOT_COMPARED.contains(&name.as_str()) {
            continue;
        }
        let name = if above.is_empty() { name.clone() } else { format!("{above}.{name}") };
        match value.as_f64() {
            Some(number) => numbers.push((name, number)),
            None => collect(numbers, &name, value),
        }
    }
}

/// Times and columns of a log.
type Table = (Vec<f64>, Vec<(String, Vec<f64>)>);

fn table(path: &Path) -> Result<Table, CliError> {
    let text = text(path)?;
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(text.as_bytes());
    let header = reader.headers().map_err(|e| wrong(path, &e))?.clone();
    let mut columns: Vec<(String, Vec<f64>)> = header.iter().map(|name| (name.into(), Vec::new())).collect();
    for record in reader.records() {
        let record = record.map_err(|e| wrong(path, &e))?;
        let line = record.position().map_or(0, csv::Position::line);
        for ((name, values), cell) in columns.iter_mut().zip(&record) {
            let number = if cell.is_empty() { Ok(f64::NAN) } else { cell.parse() };
            values.push(number.map_err(|_| {
                let path = path.display();
                CliError::Input(format!("{path}: line {line}, {name}: found {cell:?}; expected a number"))
            })?);
        }
    }
    let time = columns.iter().position(|column| column.0 == TIME || column.0 == "time_s");
    let Some(time) = time else {
        let found = columns.iter().map(|column| column.0.as_str()).collect::<Vec<_>>().join(", ");
        return Err(CliError::Input(format!("{}: found {found}; expected a column {TIME}", path.display())));
    };
    let (_, times_s) = columns.remove(time);
    if !times_s.is_sorted_by(|a, b| a < b) {
        return Err(CliError::Input(format!("{}: {TIME}: expected ascending times", path.display())));
    }
    Ok((times_s, columns))
}
