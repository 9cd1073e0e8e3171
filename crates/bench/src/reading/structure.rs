//! Checks of a description's text against the entries of its plant's sections: missing, unknown and
//! wrong fields, all of them, with their lines.
//!
//! So that the remaining checks can run on a flawed description, it is completed: unknown entries
//! are removed, missing and wrong ones replaced by a placeholder.

use crate::description::{Flaw, format_number};
use crate::effects::CATALOGUE;
use crate::log::is_signal;
use crate::schema::{FieldEntry, FieldKind, Placeholder, SectionEntry, Shape, placeholders};
use crate::signals::Channel;
use std::collections::BTreeMap;
use toml::de::{DeTable, DeValue};
use toml::{Spanned, Table, Value};

/// Text that marks a value which the user has to fill in.
pub const FILL_IN: &str = "?";

/// Flaws of the structure of a description, and the lines of its entries.
pub(super) struct Structure<'a> {
    text: &'a str,
    pub(super) flaws: Vec<Flaw>,
    /// Lines by dotted name.
    lines: BTreeMap<String, usize>,
    repairs: Vec<Repair>,
}

/// A change that makes a flawed description readable.
struct Repair {
    /// Keys from the top; an index counts the entries of an array.
    path: Vec<String>,
    replacement: Replacement,
}

#[derive(Clone, Copy)]
enum Replacement {
    Nothing,
    Field(&'static FieldEntry),
    Section(&'static [FieldEntry]),
    /// Name of any effect.
    Effect,
}

impl<'a> Structure<'a> {
    /// Checks the top-level table of a description against the sections of its plant.
    pub(super) fn check(text: &'a str, table: &DeTable<'_>, sections: &[SectionEntry]) -> Self {
        let mut structure = Self { text, flaws: Vec::new(), lines: BTreeMap::new(), repairs: Vec::new() };
        for (key, value) in table {
            let name: &str = key.get_ref();
            structure.note_line(&[name], key.span().start);
            let Some(section) = sections.iter().find(|section| section.name == name) else {
                if name != "plant" {
                    let known: Vec<&str> = sections.iter().map(|section| section.name).collect();
                    structure.refuse_unknown(&[name], "an unknown field", &known);
                }
                continue;
            };
            structure.check_section(section, value);
        }
        let is_missing = |section: &&SectionEntry| !table.keys().any(|key| key.get_ref() == section.name);
        for section in sections.iter().filter(|section| section.is_required).filter(is_missing) {
            let required = section.fields.iter().filter(|field| field.is_required());
            let names: Vec<&str> = required.map(|field| field.name).collect();
            let expected = format!("`[{}]` with {}", section.name, names.join(", "));
            structure.refuse(&[section.name], "missing", expected, Replacement::Section(section.fields));
        }
        structure
    }

    /// Line of an entry or of the section that it belongs to.
    pub(super) fn line(&self, field: &str) -> Option<usize> {
        let mut name = field.split(": ").next().unwrap_or(field);
        loop {
            if let Some(line) = self.lines.get(name) {
                return Some(*line);
            }
            name = name.rsplit_once('.')?.0;
        }
    }

    /// Returns whether an entry belongs to an effect whose name is wrong.
    pub(super) fn is_of_unknown_effect(&self, key: &str) -> bool {
        let is_own = |path: &[String]| key.starts_with(&format!("{}.", path.join(".")));
        let effects = self.repairs.iter().filter(|repair| matches!(repair.replacement, Replacement::Effect));
        effects.filter_map(|repair| repair.path.split_last()).any(|(_, entry)| is_own(entry))
    }

    /// The description with flawed entries removed or replaced.
    pub(super) fn repaired(&self, which: Placeholder) -> Option<Table> {
        let mut table: Table = toml::from_str(self.text).ok()?;
        for repair in &self.repairs {
            repair.apply(&mut table, which);
        }
        Some(table)
    }

    fn check_section(&mut self, section: &SectionEntry, value: &Spanned<DeValue<'_>>) {
        let name = section.name;
        if section.shape == Shape::Effects {
            return self.check_effects(value);
        }
        if section.shape == Shape::Entries {
            return self.check_entries(section, value);
        }
        let Some(table) = value.get_ref().as_table() else {
            let replacement = match section.shape {
                Shape::Table => Replacement::Section(section.fields),
                _ => Replacement::Nothing,
            };
            let found = found(value.get_ref());
            return self.refuse(&[name], &found, format!("a section `[{name}]`"), replacement);
        };
        match section.shape {
            Shape::Table => self.check_fields(&[name], section.fields, table),
            Shape::PerParameter => {
                for (key, value) in table {
                    let path = [name, key.get_ref()];
                    self.note_line(&path, key.span().start);
                    if number(value.get_ref()).is_none() {
                        let expected = "a standard deviation above 0, up to 1e15".into();
                        self.refuse(&path, &found(value.get_ref()), expected, Replacement::Nothing);
                    }
                }
            }
            _ => {
                let is_known = |name: &str| match section.shape {
                    Shape::PerSignal => is_signal(name),
                    _ => Channel::from_name(name).is_some(),
                };
                for (key, value) in table {
                    let path = [name, key.get_ref()];
                    self.note_line(&path, key.span().start);
                    let is_text = value.get_ref().as_str().is_some_and(|text| text != FILL_IN);
                    match value.get_ref().as_table() {
                        _ if !is_known(path[1]) => {
                            self.refuse_unknown(&path, "an unknown channel", &channels())
                        }
                        Some(table) => self.check_fields(&path, section.fields, table),
                        None if is_text && section.shape == Shape::PerSignal => {}
                        None => {
                            let names: Vec<&str> = section.fields.iter().map(|field| field.name).collect();
                            let text = if section.shape == Shape::PerSignal {
                                "a column or an expression of columns as text, or "
                            } else {
                                ""
                            };
                            let names = names.join(", ");
                            let expected = format!("{text}a table, {{ ... }}, with some of {names}");
                            self.refuse(&path, &found(value.get_ref()), expected, Replacement::Nothing);
                        }
                    }
                }
            }
        }
    }

    /// Checks the fields of a table.
    fn check_fields(&mut self, path: &[&str], fields: &'static [FieldEntry], table: &DeTable<'_>) {
        for (key, value) in table {
            let name: &str = key.get_ref();
            let path = [path, &[name]].concat();
            self.note_line(&path, key.span().start);
            match fields.iter().find(|field| field.name == name) {
                Some(field) => self.check_value(&path, field, value.get_ref()),
                None => {
                    let known: Vec<&str> = fields.iter().map(|field| field.name).collect();
                    self.refuse_unknown(&path, "an unknown field", &known);
                }
            }
        }
        let is_missing = |field: &&FieldEntry| !table.keys().any(|key| key.get_ref() == field.name);
        for field in fields.iter().filter(|field| field.is_required()).filter(is_missing) {
            let expected = format!("{} ({})", field.expected(), clause(&field.meaning()));
            self.refuse(&[path, &[field.name]].concat(), "missing", expected, Replacement::Field(field));
        }
    }

    fn check_value(&mut self, path: &[&str], field: &'static FieldEntry, value: &DeValue<'_>) {
        if field.kind.is_table() {
            return self.check_numbers(path, field, value);
        }
        let is_of_kind = match field.kind {
            FieldKind::Number => number(value).is_some(),
            FieldKind::Integer => value.is_integer(),
            FieldKind::Switch => value.is_bool(),
            FieldKind::Name(names) => value.as_str().is_some_and(|name| names().contains(&name)),
            FieldKind::Column => value.as_str().is_some_and(|name| name != FILL_IN) || is_index(value),
            FieldKind::NumberPerChannel => false,
            FieldKind::Points => is_list_of_pairs(value),
            FieldKind::Text => value.as_str().is_some_and(|text| !text.is_empty() && text != FILL_IN),
            FieldKind::Pair => return self.check_pair(path, field, value),
        };
        if !is_of_kind {
            return self.refuse(path, &found(value), field.expected(), Replacement::Field(field));
        }
        if let (Some((min, max)), Some(number)) = (field.range, number(value))
            && !(min..=max).contains(&number)
        {
            let expected = in_unit_of_channel(field.range_words().unwrap_or_default(), path);
            self.refuse(path, &format_number(number), expected, Replacement::Field(field));
        }
    }

    /// Checks an array of two numbers.
    fn check_pair(&mut self, path: &[&str], field: &'static FieldEntry, value: &DeValue<'_>) {
        let array = value.as_array().filter(|array| array.len() == 2);
        let pair = array.map(|array| array.iter().filter_map(|entry| number(entry.get_ref())).collect());
        let Some(pair) = pair.filter(|pair: &Vec<f64>| pair.len() == 2) else {
            return self.refuse(path, &found(value), field.expected(), Replacement::Field(field));
        };
        let (min, max) = field.range.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
        if let Some(outside) = pair.iter().find(|number| !(min..=max).contains(*number)) {
            let expected = format!("each {}", field.range_words().unwrap_or_default());
            self.refuse(path, &format_number(*outside), expected, Replacement::Field(field));
        }
    }

    /// Checks a table with a number for each channel.
    fn check_numbers(&mut self, path: &[&str], field: &FieldEntry, value: &DeValue<'_>) {
        let Some(table) = value.as_table() else {
            return self.refuse(path, &found(value), field.expected(), Replacement::Nothing);
        };
        let (min, max) = field.range.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
        for (key, value) in table {
            let path = [path, &[key.get_ref()]].concat();
            self.note_line(&path, key.span().start);
            let number = number(value.get_ref());
            if Channel::from_name(key.get_ref()).is_none() {
                self.refuse_unknown(&path, "an unknown channel", &channels());
            } else if !number.is_some_and(|number| (min..=max).contains(&number)) {
                let found = number.map_or_else(|| found(value.get_ref()), format_number);
                let expected = in_unit_of_channel(field.range_words().unwrap_or_default(), &path);
                self.refuse(&path, &found, expected, Replacement::Nothing);
            }
        }
    }

    /// Checks the fields of each entry of `[[name]]`.
    fn check_entries(&mut self, section: &SectionEntry, value: &Spanned<DeValue<'_>>) {
        let name = section.name;
        let Some(entries) = value.get_ref().as_array() else {
            let expected = format!("entries `[[{name}]]`");
            return self.refuse(&[name], &found(value.get_ref()), expected, Replacement::Nothing);
        };
        for (index, entry) in entries.iter().enumerate() {
            let index = index.to_string();
            let path = [name, index.as_str()];
            self.note_line(&path, entry.span().start);
            match entry.get_ref().as_table() {
                Some(table) => self.check_fields(&path, section.fields, table),
                None => {
                    let expected = "a table, { ... }".into();
                    self.refuse(
                        &path,
                        &found(entry.get_ref()),
                        expected,
                        Replacement::Section(section.fields),
                    );
                }
            }
        }
    }

    /// Checks the entries of `[[effects]]`: names and types. Parameters are checked with the bench.
    fn check_effects(&mut self, value: &Spanned<DeValue<'_>>) {
        let Some(entries) = value.get_ref().as_array() else {
            let expected = "entries `[[effects]]`".into();
            return self.refuse(&["effects"], &found(value.get_ref()), expected, Replacement::Nothing);
        };
        for (index, entry) in entries.iter().enumerate() {
            let index = index.to_string();
            self.note_line(&["effects", &index], entry.span().start);
            let Some(table) = entry.get_ref().as_table() else {
                let found = found(entry.get_ref());
                self.refuse(&["effects", &index], &found, "a table with `name`".into(), Replacement::Nothing);
                continue;
            };
            let known = CATALOGUE.iter().map(|kind| kind.name).collect::<Vec<_>>();
            let name = table.iter().find(|(key, _)| key.get_ref() == "name");
            if let Some((key, _)) = name {
                self.note_line(&["effects", &index, "name"], key.span().start);
            }
            let name = name.map(|(_, value)| value.get_ref());
            if !name.is_some_and(|name| name.as_str().is_some_and(|name| known.contains(&name))) {
                let found = name.map_or_else(|| "missing".into(), found);
                let found = if name.is_some_and(DeValue::is_str) {
                    format!("{found}, which is not a known effect")
                } else {
                    found
                };
                let expected = format!("one of {}", known.join(", "));
                self.refuse(&["effects", &index, "name"], &found, expected, Replacement::Effect);
                continue;
            }
            for (key, value) in table.iter().filter(|(key, _)| key.get_ref() != "name") {
                let path = ["effects", &index, key.get_ref()];
                self.note_line(&path, key.span().start);
                let value = value.get_ref();
                match path[2] {
                    "channel" => {
                        if value.as_str().and_then(Channel::from_name).is_none() {
                            self.refuse_unknown(&path, &found(value), &channels());
                        }
                    }
                    "of" => {
                        if !value.is_str() {
                            let expected = "the name of a body or joint".into();
                            self.refuse(&path, &found(value), expected, Replacement::Nothing);
                        }
                    }
                    _ if number(value).is_none() => {
                        self.refuse(&path, &found(value), "a number".into(), Replacement::Nothing);
                    }
                    _ => {}
                }
            }
        }
    }

    fn refuse_unknown(&mut self, path: &[&str], found: &str, known: &[&str]) {
        self.refuse(path, found, format!("one of {}", known.join(", ")), Replacement::Nothing);
    }

    fn refuse(&mut self, path: &[&str], found: &str, expected: String, replacement: Replacement) {
        let field = path.join(".");
        self.flaws.push(Flaw { line: self.line(&field), field, found: found.into(), expected });
        let path = path.iter().map(|key| (*key).to_owned()).collect();
        self.repairs.push(Repair { path, replacement });
    }

    fn note_line(&mut self, path: &[&str], start: usize) {
        let before = self.text.get(..start).unwrap_or(self.text);
        self.lines.entry(path.join(".")).or_insert_with(|| before.matches('\n').count() + 1);
    }
}

impl Repair {
    fn apply(&self, table: &mut Table, which: Placeholder) {
        let Some((last, parents)) = self.path.split_last() else { return };
        let replacement = match self.replacement {
            Replacement::Nothing => None,
            Replacement::Field(field) => Some(which.value(field)),
            Replacement::Section(fields) => Some(Value::Table(placeholders(fields, which))),
            Replacement::Effect => CATALOGUE.first().map(|kind| Value::String(kind.name.into())),
        };
        let Some(first) = parents.first() else {
            match replacement {
                Some(value) => drop(table.insert(last.clone(), value)),
                None => drop(table.remove(last)),
            }
            return;
        };
        let mut place = table.get_mut(first);
        for key in parents.iter().skip(1) {
            place = place.and_then(|value| match value {
                Value::Array(entries) => entries.get_mut(key.parse::<usize>().ok()?),
                value => value.get_mut(key),
            });
        }
        match (place, replacement) {
            (Some(Value::Table(table)), Some(value)) => drop(table.insert(last.clone(), value)),
            (Some(Value::Table(table)), None) => drop(table.remove(last)),
            (Some(Value::Array(entries)), Some(value)) => {
                if let Some(entry) = last.parse::<usize>().ok().and_then(|index| entries.get_mut(index)) {
                    *entry = value;
                }
            }
            _ => {}
        }
    }
}

/// Names of all channels.
fn channels() -> Vec<&'static str> {
    Channel::ALL.iter().map(|channel| channel.name()).collect()
}

/// Names the unit of the channel in a path.
fn in_unit_of_channel(expected: String, path: &[&str]) -> String {
    let channel = path.iter().find_map(|key| Channel::from_name(key));
    channel.map_or_else(|| expected.clone(), |channel| expected.replace("the channel's", channel.unit()))
}

/// A number as TOML writes it; an integer is one too.
fn number(value: &DeValue<'_>) -> Option<f64> {
    let digits = |text: &str| text.replace('_', "");
    match value {
        DeValue::Float(float) => digits(float.as_str()).parse().ok(),
        DeValue::Integer(integer) => {
            i64::from_str_radix(&digits(integer.as_str()), integer.radix()).ok().map(|integer| integer as f64)
        }
        _ => None,
    }
}

fn is_list_of_pairs(value: &DeValue<'_>) -> bool {
    let is_pair = |entry: &Spanned<DeValue<'_>>| {
        entry
            .get_ref()
            .as_array()
            .is_some_and(|pair| pair.len() == 2 && pair.iter().all(|v| number(v.get_ref()).is_some()))
    };
    value.as_array().is_some_and(|entries| entries.iter().all(is_pair))
}

fn is_index(value: &DeValue<'_>) -> bool {
    value.is_integer() && number(value).is_some_and(|index| index >= 0.0)
}

/// Content found, as it completes "the field is ...".
fn found(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(text) if text == FILL_IN => "not filled in".into(),
        DeValue::String(text) => format!("`{text}`"),
        DeValue::Integer(integer) => integer.as_str().into(),
        DeValue::Float(float) => float.as_str().into(),
        DeValue::Boolean(value) => value.to_string(),
        DeValue::Datetime(time) => time.to_string(),
        DeValue::Array(_) => "an array".into(),
        DeValue::Table(_) => "a table".into(),
    }
}

/// Converts a sentence into a clause.
fn clause(sentence: &str) -> String {
    let mut letters = sentence.trim_end_matches('.').chars();
    let first = letters.next().map(|first| first.to_lowercase().collect::<String>()).unwrap_or_default();
    first + letters.as_str()
}
