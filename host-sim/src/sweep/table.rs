//! The result of a sweep as CSV and JSON, independent of the clock, the order and the number of
//! threads.

use super::journal::Record;
use super::points::Point;
use super::specification::Specification;
use crate::cli::error::CliError;
use crate::run::summary::Figures;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;

/// One run of a sweep: its parameters and its figures or the reason why it has none.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(crate) struct Row<'a> {
    /// Number of the point.
    pub(crate) index: usize,
    /// Parameter values by path.
    pub(crate) parameters: BTreeMap<&'a str, f64>,
    /// The figures.
    #[serde(flatten)]
    pub(crate) figures: Option<&'a Figures>,
    /// The reason why there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) error: Option<&'a str>,
}

/// The rows of a sweep in the order of its points.
pub(crate) fn rows<'a>(
    specification: &'a Specification,
    points: &'a [Point],
    records: &'a [Record],
) -> Vec<Row<'a>> {
    points
        .iter()
        .zip(records)
        .map(|(point, record)| Row {
            index: record.index,
            parameters: specification
                .parameters
                .iter()
                .map(|p| p.path.as_str())
                .zip(point.values.iter().copied())
                .collect(),
            figures: record.outcome.as_ref().ok(),
            error: record.outcome.as_ref().err().map(String::as_str),
        })
        .collect()
}

/// Formats rows as CSV. Columns have the order of first appearance; the names of nested fields are
/// joined by dots.
pub(crate) fn csv<T: Serialize>(rows: &[T]) -> Result<String, CliError> {
    let failed = |e: &dyn std::fmt::Display| CliError::Work(format!("csv: {e}"));
    let mut columns: Vec<String> = Vec::new();
    let mut table: Vec<BTreeMap<String, String>> = Vec::with_capacity(rows.len());
    for row in rows {
        let value = serde_json::to_value(row).map_err(|e| failed(&e))?;
        let mut cells = Vec::new();
        flatten("", &value, &mut cells);
        for (name, _) in &cells {
            if !columns.contains(name) {
                columns.push(name.clone());
            }
        }
        table.push(cells.into_iter().collect());
    }
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(&columns).map_err(|e| failed(&e))?;
    for cells in &table {
        let record = columns.iter().map(|c| cells.get(c).map_or("", String::as_str));
        writer.write_record(record).map_err(|e| failed(&e))?;
    }
    let bytes = writer.into_inner().map_err(|e| failed(&e))?;
    String::from_utf8(bytes).map_err(|e| failed(&e))
}

fn flatten(path: &str, value: &serde_json::Value, cells: &mut Vec<(String, String)>) {
    use serde_json::Value;
    let join = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    match value {
        Value::Object(map) => map.iter().for_each(|(key, v)| flatten(&join(key), v, cells)),
        Value::Array(list) => {
            list.iter().enumerate().for_each(|(i, v)| flatten(&join(&i.to_string()), v, cells));
        }
        Value::Null => cells.push((path.to_owned(), String::new())),
        Value::String(text) => cells.push((path.to_owned(), text.clone())),
        other => cells.push((path.to_owned(), other.to_string())),
    }
}
