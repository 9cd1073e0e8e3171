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
    /// Texts of run.json, named in the same way.
    pub(super) texts: Vec<(String, String)>,
    /// Times of the log, s, ascending.
    pub(super) times_s: Vec<f64>,
    /// Columns of the log; a missing value is not a number.
    pub(super) columns: Vec<(String, Vec<f64>)>,
}

impl StoredRun {
    pub(super) fn figure(&self, name: &str) -> Option<f64> {
        self.figures.iter().find(|figure| figure.0 == name).map(|figure| figure.1)
    }

    pub(super) fn text(&self, name: &str) -> Option<&String> {
        self.texts.iter().find(|text| text.0 == name).map(|text| &text.1)
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
    if !value.is_object() {
        return Err(wrong(&figures, &"found no object"));
    }
    let mut run = StoredRun { figures: vec![], texts: vec![], times_s: vec![], columns: vec![] };
    collect(&mut run, "", &value);
    (run.times_s, run.columns) = table(&folder.join("log.csv"))?;
    Ok(run)
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

/// Collects the numbers and texts of an object and of the objects in it. Of lists only objects with
/// a name are compared, such as contacts; other lists belong to one run alone.
fn collect(run: &mut StoredRun, above: &str, value: &Value) {
    let items: Vec<(&str, &Value)> = match value {
        Value::Object(items) => items.iter().map(|(name, value)| (name.as_str(), value)).collect(),
        Value::Array(items) => items.iter().filter_map(|v| Some((v.get("name")?.as_str()?, v))).collect(),
        _ => vec![],
    };
    for (name, value) in items {
        if NOT_COMPARED.contains(&name) {
            continue;
        }
        let name = if above.is_empty() { name.to_owned() } else { format!("{above}.{name}") };
        match value {
            Value::Number(number) => run.figures.extend(number.as_f64().map(|number| (name, number))),
            Value::String(text) => run.texts.push((name, text.clone())),
            nested => collect(run, &name, nested),
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
