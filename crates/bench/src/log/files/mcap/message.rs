//! Messages in the serialisation of ROS 1 and in CDR of ROS 2, along their definition.

use super::cursor::Cursor;
use super::definition::{Count, Definition, Dialect, Field, Kind, Number};
use super::table::{Flaw, LONG_ARRAY, Row, TEXTS};
use crate::log::files::file::MAX_COLUMNS;
use std::collections::HashSet;
use std::fmt::Write;
use std::rc::Rc;

/// Fields whose texts name the elements of the arrays after them.
pub(super) const NAMING: [&str; 4] = ["name", "names", "joint_names", "interface_names"];
/// Maximum length of the name of an element.
const MAX_ELEMENT_BYTES: usize = 255;
/// Bytes before a message in CDR, which state its representation.
const CDR_HEAD_BYTES: usize = 4;
/// Maximum number of bytes that a writer adds to a message in CDR.
const MAX_PADDING_BYTES: usize = 3;

/// Adds the numbers of a message to a row. Paths begin with the topic.
pub(super) fn read(definition: &Definition, data: &[u8], topic: &str, row: &mut Row<'_>) -> Result<(), Flaw> {
    let cursor = match (definition.dialect, data.split_at_checked(CDR_HEAD_BYTES)) {
        (Dialect::Ros1, _) => Cursor::packed(data),
        (Dialect::Ros2, Some(([0, order @ (0 | 1), ..], body))) => Cursor::aligned(body, *order == 0),
        (Dialect::Ros2, _) => return Err("a representation other than plain CDR".into()),
    };
    let mut reader = Reader { definition, cursor, row, path: topic.into(), is_silent: false };
    reader.message(0, None)?;
    let left = reader.cursor.left();
    let max_left = if definition.dialect == Dialect::Ros1 { 0 } else { MAX_PADDING_BYTES };
    if left > max_left {
        return Err(format!("{left} bytes after the last field of its definition").into());
    }
    Ok(())
}

/// Names of the elements of arrays.
pub(super) type Names = Rc<Vec<String>>;

/// Returns texts as names of elements if they are distinct and printable.
pub(super) fn names(texts: Vec<String>) -> Option<Names> {
    let is_name = |text: &String| {
        (1..=MAX_ELEMENT_BYTES).contains(&text.len())
            && !text.contains(|c: char| c.is_control() || "[]".contains(c))
    };
    let distinct: HashSet<&String> = texts.iter().collect();
    let is_naming = distinct.len() == texts.len() && texts.iter().all(is_name);
    is_naming.then(|| Rc::new(texts))
}

/// Returns a name of a file without control characters.
pub(super) fn printable(name: &str) -> String {
    name.replace(char::is_control, "\u{fffd}")
}

/// Appends the place of an element to a path: its name, else its index.
pub(super) fn push_element(path: &mut String, index: usize, count: usize, names: Option<&Names>) {
    let name = names.filter(|names| names.len() == count).and_then(|names| names.get(index));
    let _ = match name {
        Some(name) => write!(path, "[{name}]"),
        None => write!(path, "[{index}]"),
    };
}

/// Message that is being read.
struct Reader<'a, 'b, 'c> {
    definition: &'a Definition,
    cursor: Cursor<'a>,
    row: &'b mut Row<'c>,
    path: String,
    /// True in an array that is too long for columns.
    is_silent: bool,
}

impl Reader<'_, '_, '_> {
    /// Reads a message with the names of elements of the message around it.
    fn message(&mut self, index: usize, names: Option<&Names>) -> Result<(), Flaw> {
        let definition = self.definition;
        let mut names = names.cloned();
        for field in definition.messages.get(index).map_or(&[][..], |message| &message.fields) {
            let length = self.path.len();
            self.path.push('.');
            self.path.push_str(&field.name);
            match field.count {
                Count::One => self.element(field.kind, names.as_ref())?,
                Count::Fixed(count) => names = self.array(field, count, names)?,
                Count::Stored => {
                    let count = self.cursor.u32()? as usize;
                    names = self.array(field, count, names)?;
                }
            }
            self.path.truncate(length);
        }
        Ok(())
    }

    /// Reads an array and returns the names of elements for the fields after it.
    fn array(&mut self, field: &Field, count: usize, names: Option<Names>) -> Result<Option<Names>, Flaw> {
        let min_bytes = self.definition.min_bytes(field.kind);
        if min_bytes == 0 {
            return Ok(names);
        }
        if count > self.cursor.left() / min_bytes {
            let path = &self.path;
            return Err(format!("`{path}` with {count} elements, more than the message contains").into());
        }
        if field.kind == Kind::Text && NAMING.contains(&field.name.as_str()) && count <= MAX_COLUMNS {
            let texts = (0..count).map(|_| self.text()).collect::<Result<Vec<_>, _>>()?;
            return Ok(self::names(texts).or(names));
        }
        let was_silent = self.is_silent;
        if count > MAX_COLUMNS && field.kind != Kind::Text {
            if !self.is_silent {
                self.row.other(&self.path, LONG_ARRAY)?;
            }
            if let Kind::Number(number) = field.kind {
                self.cursor.array(count, number.size())?;
                return Ok(names);
            }
            self.is_silent = true;
        }
        for index in 0..count {
            let length = self.path.len();
            if !self.is_silent {
                push_element(&mut self.path, index, count, names.as_ref());
            }
            self.element(field.kind, names.as_ref())?;
            self.path.truncate(length);
        }
        self.is_silent = was_silent;
        Ok(names)
    }

    fn element(&mut self, kind: Kind, names: Option<&Names>) -> Result<(), Flaw> {
        match kind {
            Kind::Message(_) if self.definition.min_bytes(kind) == 0 => Ok(()),
            Kind::Message(index) => self.message(index, names),
            Kind::Unused => self.cursor.u8().map(|_| ()),
            Kind::Text => {
                self.cursor.counted()?;
                if self.is_silent { Ok(()) } else { self.row.other(&self.path, TEXTS) }
            }
            Kind::Time | Kind::Duration => {
                let (seconds, ns) = (self.cursor.u32()?, i64::from(self.cursor.u32()?));
                // Times of ROS 1 are unsigned, all others signed.
                let is_unsigned = kind == Kind::Time && self.definition.dialect == Dialect::Ros1;
                let seconds = if is_unsigned { i64::from(seconds) } else { i64::from(seconds.cast_signed()) };
                let sum = seconds * 1_000_000_000 + ns;
                match kind {
                    _ if self.is_silent => Ok(()),
                    Kind::Time => self.row.time(&self.path, sum),
                    _ => self.row.duration(&self.path, sum),
                }
            }
            Kind::Number(number) => {
                let value = self.number(number)?;
                if self.is_silent { Ok(()) } else { self.row.number(&self.path, value) }
            }
        }
    }

    fn number(&mut self, number: Number) -> Result<f64, Flaw> {
        let cursor = &mut self.cursor;
        Ok(match number {
            Number::Bool => f64::from(u8::from(cursor.u8()? != 0)),
            Number::I8 => f64::from(cursor.u8()?.cast_signed()),
            Number::U8 => f64::from(cursor.u8()?),
            Number::I16 => f64::from(cursor.u16()?.cast_signed()),
            Number::U16 => f64::from(cursor.u16()?),
            Number::I32 => f64::from(cursor.u32()?.cast_signed()),
            Number::U32 => f64::from(cursor.u32()?),
            Number::I64 => cursor.u64()?.cast_signed() as f64,
            Number::U64 => cursor.u64()? as f64,
            Number::F32 => f64::from(f32::from_bits(cursor.u32()?)),
            Number::F64 => f64::from_bits(cursor.u64()?),
        })
    }

    /// Reads a text; CDR ends it with a zero.
    fn text(&mut self) -> Result<String, Flaw> {
        let text = self.cursor.text()?;
        Ok(text.trim_end_matches('\0').to_owned())
    }
}
