//! Messages in JSON.

use super::message::{NAMING, Names, names, printable, push_element};
use super::table::{Flaw, LONG_ARRAY, Row, TEXTS};
use crate::log::files::file::MAX_COLUMNS;
use serde_json::{Map, Value};

/// Maximum size of a message: parsed, it takes many times as much.
const MAX_BYTES: usize = 1 << 24;

/// Adds the numbers of a message to a row. Paths begin with the topic.
pub(super) fn read(data: &[u8], topic: &str, row: &mut Row<'_>) -> Result<(), Flaw> {
    if data.len() > MAX_BYTES {
        return Err(format!("more than {} MB of JSON", MAX_BYTES >> 20).into());
    }
    let value: Value = serde_json::from_slice(data).map_err(|error| format!("damaged JSON: {error}"))?;
    add(&value, &mut topic.to_owned(), None, row)
}

/// Adds the numbers of a value with the names of elements of the object around it.
fn add(value: &Value, path: &mut String, names: Option<&Names>, row: &mut Row<'_>) -> Result<(), Flaw> {
    match value {
        Value::Null => Ok(()),
        Value::Bool(value) => row.number(path, f64::from(u8::from(*value))),
        Value::Number(value) => row.number(path, value.as_f64().unwrap_or(f64::NAN)),
        Value::String(_) => row.other(path, TEXTS),
        Value::Array(elements) if elements.len() > MAX_COLUMNS => row.other(path, LONG_ARRAY),
        Value::Array(elements) => {
            for (index, element) in elements.iter().enumerate() {
                let length = path.len();
                push_element(path, index, elements.len(), names);
                add(element, path, names, row)?;
                path.truncate(length);
            }
            Ok(())
        }
        Value::Object(fields) => {
            if let Some(time) = time(fields).filter(|_| row.is_stamp(path)) {
                return row.time(path, time);
            }
            let own = NAMING.iter().find_map(|name| self::names(texts(fields.get(*name)?)?));
            let names = own.as_ref().or(names);
            for (name, value) in fields {
                if NAMING.contains(&name.as_str()) && own.is_some() && value.is_array() {
                    continue;
                }
                let length = path.len();
                path.push('.');
                path.push_str(&printable(name));
                add(value, path, names, row)?;
                path.truncate(length);
            }
            Ok(())
        }
    }
}

/// Texts of an array that contains nothing else.
fn texts(value: &Value) -> Option<Vec<String>> {
    value.as_array()?.iter().map(|text| text.as_str().map(str::to_owned)).collect()
}

/// Time in ns of an object that contains nothing else.
fn time(fields: &Map<String, Value>) -> Option<i64> {
    let ns = fields.get("nanosec").or_else(|| fields.get("nsec"))?.as_i64()?;
    let seconds = fields.get("sec").filter(|_| fields.len() == 2)?.as_i64()?;
    seconds.checked_mul(1_000_000_000)?.checked_add(ns)
}
