//! Numbers of a bench description as parameters of a unit.

use crate::model::Kind;
use crate::variable::{Causality, Type, Variable};
use bench::schema::{FieldEntry, SectionEntry, unit_of_name};
use toml::{Table, Value};

/// Sections about logs, diagnosis and life, and numbers that a program sets in another way.
const UNUSED: [&str; 13] = [
    "plant",
    "sensors",
    "uncertain",
    "nuisances",
    "log",
    "columns",
    "measured",
    "logging",
    "life",
    "two_plane",
    "run.duration_s",
    "run.samples",
    "run.tolerance",
];
/// Sections that the contact alone reads.
const OF_CONTACT: [&str; 3] = ["bearing", "contact", "friction"];

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

/// Collects the numbers of a description that a unit reads, with their variables. Entries of a
/// list are named by their `name`, or numbered from 1.
pub(crate) fn collect(kind: Kind, description: &Table, sections: &[SectionEntry]) -> Vec<(Leaf, Variable)> {
    let mut found = Vec::new();
    let is_read = |name: &str| kind != Kind::Contact || OF_CONTACT.contains(&name);
    for (name, value) in description.iter().filter(|(name, _)| is_read(name)) {
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
    if UNUSED.contains(&name.as_str()) {
        return;
    }
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
                let name_of = |entry: &Value| entry.get("name").and_then(Value::as_str).map(str::to_owned);
                let own = name_of(entry);
                // Effects on sensors do not act on the motion.
                if name == "effects" && own.as_ref().is_some_and(|own| own.starts_with("sensor-")) {
                    continue;
                }
                let is_unique = entries.iter().filter(|other| name_of(other) == own).count() == 1;
                let label = own.filter(|_| is_unique).unwrap_or_else(|| (index + 1).to_string());
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

#[cfg(test)]
mod tests {
    use super::*;
    use bench::Bench;

    #[test]
    fn every_parameter_reaches_its_own_place_in_the_description() {
        for (kind, name) in
            [(Kind::Contact, "bench-b"), (Kind::Bench, "bench-b"), (Kind::Mechanism, "four-bar")]
        {
            let bench = Bench::open(name).unwrap();
            let table: Table = bench.to_toml().unwrap().parse().unwrap();
            let sections = Bench::sections(bench.plant_name()).unwrap();
            let leaves = collect(kind, &table, &sections);
            for (i, (leaf, variable)) in leaves.iter().enumerate() {
                let mut changed = table.clone();
                leaf.put(&mut changed, variable.start + 1.0);
                let found = collect(kind, &changed, &sections);
                let starts = found.iter().zip(&leaves).enumerate();
                for (other, ((_, found), (_, known))) in starts {
                    assert_eq!(found.name, known.name);
                    let expected = known.start + f64::from(u8::from(other == i));
                    assert_eq!(found.start, expected, "{} changed, {} read", variable.name, known.name);
                }
            }
            let names: Vec<&str> = leaves.iter().map(|(_, variable)| variable.name.as_str()).collect();
            let has = |name: &str| names.contains(&name);
            match kind {
                Kind::Contact => assert!(has("bearing.radial_clearance_m") && !has("shaft.mass_kg")),
                Kind::Bench => {
                    assert!(has("shaft.mass_kg") && has("drive.cycles") && !has("logging.sample_rate_hz"))
                }
                Kind::Mechanism => {
                    assert!(has("body.crank.mass_kg") && has("joint.3.clearance_m") && !has("run.tolerance"));
                }
            }
        }
    }
}
