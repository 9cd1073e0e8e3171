//! Numbers of a bench description as parameters of a unit.

use crate::variable::{Causality, Type, Variable};
use bench::schema::{FieldEntry, SectionEntry, unit_of_name};
use toml::{Table, Value};

/// Sections about logs and diagnosis, which a simulation does not read.
const UNUSED: [&str; 9] =
    ["plant", "sensors", "uncertain", "nuisances", "log", "columns", "measured", "logging", "life"];

/// Number of a description and where it is.
#[derive(Clone, Debug)]
pub(crate) struct Leaf {
    path: Vec<Step>,
    is_integer: bool,
}

/// One step into a description.
#[derive(Clone, Debug)]
enum Step {
    Key(String),
    Index(usize),
}

/// Collects the numbers of a description with their variables. Entries of a list are named by
/// their `name`, or numbered from 1.
pub(crate) fn collect(description: &Table, sections: &[SectionEntry]) -> Vec<(Leaf, Variable)> {
    let mut found = Vec::new();
    for (name, value) in description.iter().filter(|(name, _)| !UNUSED.contains(&name.as_str())) {
        let section = sections.iter().find(|section| section.name == name);
        let fields = section.map_or(&[][..], |section| section.fields);
        walk(value, &mut vec![Step::Key(name.clone())], name.clone(), None, fields, &mut found);
    }
    found
}

fn walk(
    value: &Value,
    path: &mut Vec<Step>,
    name: String,
    field: Option<&FieldEntry>,
    fields: &[FieldEntry],
    found: &mut Vec<(Leaf, Variable)>,
) {
    match value {
        Value::Float(number) => found.push((leaf(path, false), variable(&name, *number, false, field))),
        Value::Integer(number) => {
            found.push((leaf(path, true), variable(&name, *number as f64, true, field)))
        }
        Value::Table(table) => {
            for (key, value) in table {
                path.push(Step::Key(key.clone()));
                let field = fields.iter().find(|field| field.name == key);
                walk(value, path, format!("{name}.{key}"), field, fields, found);
                path.pop();
            }
        }
        Value::Array(entries) => {
            for (index, entry) in entries.iter().enumerate() {
                let own = entry.get("name").and_then(Value::as_str);
                let label = own.map_or_else(|| (index + 1).to_string(), str::to_owned);
                path.push(Step::Index(index));
                walk(entry, path, format!("{name}.{label}"), field, fields, found);
                path.pop();
            }
        }
        Value::String(_) | Value::Boolean(_) | Value::Datetime(_) => {}
    }
}

fn leaf(path: &[Step], is_integer: bool) -> Leaf {
    Leaf { path: path.to_vec(), is_integer }
}

fn variable(name: &str, start: f64, is_integer: bool, field: Option<&FieldEntry>) -> Variable {
    let last = name.rsplit('.').find(|part| part.parse::<usize>().is_err()).unwrap_or(name);
    let unit = field.map_or_else(|| unit_of_name(last), FieldEntry::unit);
    let meaning = field.map_or_else(|| format!("`{name}` of the description"), FieldEntry::meaning);
    let kind = if is_integer { Type::Integer } else { Type::Real };
    let range = field.and_then(|field| field.range).filter(|(low, high)| (low..=high).contains(&&start));
    Variable { range, ..Variable::real(Causality::Fixed, name, unit, &meaning).with(kind, start) }
}

impl Leaf {
    /// Writes a number into a description.
    pub(crate) fn put(&self, description: &mut Table, number: f64) {
        let mut steps = self.path.iter();
        let Some(Step::Key(section)) = steps.next() else { return };
        let mut place = description.get_mut(section);
        for step in steps {
            place = place.and_then(|value| match step {
                Step::Key(key) => value.get_mut(key),
                Step::Index(index) => value.get_mut(index),
            });
        }
        if let Some(place) = place {
            *place = if self.is_integer { Value::Integer(number as i64) } else { Value::Float(number) };
        }
    }
}
