//! Definitions of messages in the text of ROS 1 (`ros1msg`) and ROS 2 (`ros2msg`).
//!
//! A text is the definition of a type, then those of the types in it, each after a line of `=` and
//! a line `MSG: package/Type`.

use std::collections::HashMap;

/// Maximum depth of types in types.
const MAX_DEPTH: usize = 32;
/// Maximum length of the name of a field.
const MAX_FIELD_BYTES: usize = 255;

/// Generation of ROS, which differ in types and serialisation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Dialect {
    Ros1,
    Ros2,
}

/// Kind of a stored number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Number {
    Bool,
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Number {
    /// Size in bytes.
    pub(super) fn size(self) -> usize {
        match self {
            Self::Bool | Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }
}

/// Content of a field or of an element of its array.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    Number(Number),
    Text,
    Time,
    Duration,
    /// Byte that stands for a message without fields.
    Unused,
    /// Message by its index.
    Message(usize),
}

/// Number of elements of a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Count {
    One,
    Fixed(usize),
    Stored,
}

/// Field of a message.
#[derive(Debug, PartialEq)]
pub(super) struct Field {
    pub(super) name: String,
    pub(super) kind: Kind,
    pub(super) count: Count,
}

/// Type of a message.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Message {
    pub(super) fields: Vec<Field>,
    /// Minimum size in bytes.
    pub(super) min_bytes: usize,
}

/// Definition of a type with the types in it.
#[derive(Debug, PartialEq)]
pub(super) struct Definition {
    pub(super) dialect: Dialect,
    /// Types; the first one is that of the messages.
    pub(super) messages: Vec<Message>,
}

impl Definition {
    /// Parses a text; the error is what was found.
    pub(super) fn parse(name: &str, text: &str, dialect: Dialect) -> Result<Self, String> {
        let mut parts: Vec<(String, Vec<&str>)> = vec![(short(name), Vec::new())];
        let mut lines = text.lines();
        while let Some(line) = lines.next() {
            if line.starts_with("====") {
                let head = lines.next().and_then(|line| line.trim().strip_prefix("MSG:"));
                let head = head.ok_or("a definition without `MSG:`")?;
                parts.push((short(head.trim()), Vec::new()));
            } else if let Some((_, lines)) = parts.last_mut() {
                lines.push(line);
            }
        }
        let known: HashMap<&str, usize> =
            parts.iter().enumerate().rev().map(|(index, (name, _))| (name.as_str(), index)).collect();
        let mut out = Self { dialect, messages: Vec::new() };
        for (name, lines) in &parts {
            let types = Types { known: &known, package: name.split('/').next().unwrap_or_default(), dialect };
            let fields = lines.iter().filter_map(|line| types.field(line).transpose());
            let mut fields = fields.collect::<Result<Vec<_>, _>>()?;
            if fields.is_empty() && dialect == Dialect::Ros2 {
                fields.push(Field { name: String::new(), kind: Kind::Unused, count: Count::One });
            }
            out.messages.push(Message { fields, min_bytes: 0 });
        }
        let mut sizes = vec![None; out.messages.len()];
        out.measure(0, MAX_DEPTH, &mut sizes)?;
        for (message, size) in out.messages.iter_mut().zip(&sizes) {
            message.min_bytes = size.map_or(0, |(bytes, _)| bytes);
        }
        Ok(out)
    }

    /// Minimum size of a type and the depth of types in it; refuses a type that contains itself.
    fn measure(
        &self,
        index: usize,
        max_depth: usize,
        sizes: &mut Vec<Option<(usize, usize)>>,
    ) -> Result<(usize, usize), String> {
        let known = sizes.get(index).copied().flatten();
        if max_depth == 0 || known.is_some_and(|(_, depth)| depth > max_depth) {
            return Err(format!("types that contain themselves, or more than {MAX_DEPTH} levels of types"));
        }
        if let Some(known) = known {
            return Ok(known);
        }
        let (mut bytes, mut depth) = (0_usize, 1);
        for field in self.messages.get(index).map_or(&[][..], |message| &message.fields) {
            let element = match field.kind {
                Kind::Message(inner) => {
                    let (bytes, below) = self.measure(inner, max_depth - 1, sizes)?;
                    depth = depth.max(below + 1);
                    bytes
                }
                kind => kind.min_bytes(),
            };
            let all = match field.count {
                Count::One => element,
                Count::Fixed(count) => element.saturating_mul(count),
                Count::Stored => 4,
            };
            bytes = bytes.saturating_add(all);
        }
        if let Some(size) = sizes.get_mut(index) {
            *size = Some((bytes, depth));
        }
        Ok((bytes, depth))
    }

    /// Minimum size of an element in bytes.
    pub(super) fn min_bytes(&self, kind: Kind) -> usize {
        match kind {
            Kind::Message(index) => self.messages.get(index).map_or(0, |message| message.min_bytes),
            kind => kind.min_bytes(),
        }
    }
}

impl Kind {
    /// Minimum size in bytes of content that is no message.
    fn min_bytes(self) -> usize {
        match self {
            Self::Number(number) => number.size(),
            Self::Text => 4,
            Self::Time | Self::Duration => 8,
            Self::Unused => 1,
            Self::Message(_) => 0,
        }
    }
}

/// Name of a type as `package/Type`.
fn short(name: &str) -> String {
    name.replacen("/msg/", "/", 1)
}

/// Types that a definition may name.
struct Types<'a> {
    known: &'a HashMap<&'a str, usize>,
    package: &'a str,
    dialect: Dialect,
}

impl Types<'_> {
    /// Field of a line; `None` for a constant, a comment or an empty line.
    fn field(&self, line: &str) -> Result<Option<Field>, String> {
        let line = line.split('#').next().unwrap_or_default().trim();
        let Some((kind, rest)) = line.split_once(char::is_whitespace) else {
            return if line.is_empty() { Ok(None) } else { Err(unreadable(line)) };
        };
        let rest = rest.trim_start();
        let end = rest.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).unwrap_or(rest.len());
        let (name, after) = rest.split_at(end);
        if after.trim_start().starts_with('=') {
            return Ok(None);
        }
        if name.is_empty() || name.len() > MAX_FIELD_BYTES {
            return Err(unreadable(line));
        }
        let (kind, count) = self.count(kind).ok_or_else(|| unreadable(line))?;
        let kind = self.kind(kind).ok_or_else(|| format!("the type `{}`", shown(kind)))?;
        Ok(Some(Field { name: name.into(), kind, count }))
    }

    /// Splits the brackets of an array from a type.
    fn count<'a>(&self, kind: &'a str) -> Option<(&'a str, Count)> {
        let Some((kind, count)) = kind.strip_suffix(']').and_then(|kind| kind.rsplit_once('[')) else {
            return Some((kind, Count::One));
        };
        let count = match count {
            count if count.is_empty() || count.starts_with("<=") => Count::Stored,
            count => Count::Fixed(count.parse().ok()?),
        };
        Some((kind, count))
    }

    fn kind(&self, name: &str) -> Option<Kind> {
        let is_ros_1 = self.dialect == Dialect::Ros1;
        // The length of a bounded text does not matter.
        Some(match name.split("<=").next().unwrap_or_default() {
            "bool" => Kind::Number(Number::Bool),
            "int8" => Kind::Number(Number::I8),
            "byte" if is_ros_1 => Kind::Number(Number::I8),
            "uint8" | "char" | "byte" => Kind::Number(Number::U8),
            "int16" => Kind::Number(Number::I16),
            "uint16" => Kind::Number(Number::U16),
            "int32" => Kind::Number(Number::I32),
            "uint32" => Kind::Number(Number::U32),
            "int64" => Kind::Number(Number::I64),
            "uint64" => Kind::Number(Number::U64),
            "float32" => Kind::Number(Number::F32),
            "float64" => Kind::Number(Number::F64),
            "string" => Kind::Text,
            "time" if is_ros_1 => Kind::Time,
            "duration" if is_ros_1 => Kind::Duration,
            name => return self.message(name),
        })
    }

    /// Message of a name, of the own package without one.
    fn message(&self, name: &str) -> Option<Kind> {
        let name = short(name);
        let own = format!("{}/{name}", self.package);
        let is_own = !name.contains('/');
        match if is_own { own.as_str() } else { name.as_str() } {
            "builtin_interfaces/Time" => return Some(Kind::Time),
            "builtin_interfaces/Duration" => return Some(Kind::Duration),
            _ => {}
        }
        let header = (name == "Header").then_some("std_msgs/Header");
        let found = self.known.get(if is_own { &own } else { &name }.as_str());
        found.or_else(|| self.known.get(header?)).map(|index| Kind::Message(*index))
    }
}

fn unreadable(line: &str) -> String {
    format!("the line `{}` in its definition", shown(line))
}

/// The start of a text, without control characters.
fn shown(text: &str) -> String {
    text.chars().take(60).flat_map(char::escape_debug).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str, dialect: Dialect) -> Result<Definition, String> {
        Definition::parse("a/msg/A", text, dialect)
    }

    #[test]
    fn types_of_both_dialects_are_found() {
        let text = "# comment\nint32 LIMIT=5\nstring NAME = a # b\nHeader header\nbyte b\ntime[2] t\n\
                    B[] list\n\
                    ================\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n\
                    ================\nMSG: a/B\nfloat64[<=3] x\n";
        let found = parse(text, Dialect::Ros1).unwrap();
        let fields: Vec<(&str, Kind, Count)> =
            found.messages[0].fields.iter().map(|f| (f.name.as_str(), f.kind, f.count)).collect();
        let expected = [
            ("header", Kind::Message(1), Count::One),
            ("b", Kind::Number(Number::I8), Count::One),
            ("t", Kind::Time, Count::Fixed(2)),
            ("list", Kind::Message(2), Count::Stored),
        ];
        assert_eq!(fields, expected);
        assert_eq!((found.messages[0].min_bytes, found.messages[2].min_bytes), (16 + 1 + 16 + 4, 4));
        let text = "builtin_interfaces/Time stamp\nint32 x 5\nstring<=8[<=2] names [\"a\"]\nEmpty e\n\
                    ====\nMSG: a/Empty\n";
        let found = parse(text, Dialect::Ros2).unwrap();
        assert_eq!(found.messages[0].fields[0].kind, Kind::Time);
        assert_eq!(found.messages[0].fields[2].count, Count::Stored);
        assert_eq!((found.messages[0].min_bytes, found.messages[1].min_bytes), (8 + 4 + 4 + 1, 1));
    }

    #[test]
    fn a_definition_that_cannot_be_read_is_refused_with_the_reason() {
        for (text, expected) in [
            ("A next", "types that contain themselves"),
            ("B b\n====\nMSG: a/B\nC c\n====\nMSG: a/C\nB[] b", "types that contain themselves"),
            ("Missing x", "the type `Missing`"),
            ("wstring x", "the type `wstring`"),
            ("float64", "the line `float64`"),
            ("float64[-1] x", "the line `float64[-1] x`"),
            ("float64 x\n====\nfloat64 y", "a definition without `MSG:`"),
        ] {
            let refused = parse(text, Dialect::Ros2).unwrap_err();
            assert!(refused.starts_with(expected), "{text}: {refused}");
        }
        let mut chain = "T0 x\n".to_owned();
        for depth in 0..40 {
            chain += &format!("====\nMSG: a/T{depth}\nT{} x\n", depth + 1);
        }
        assert!(parse(&chain, Dialect::Ros2).is_err());
    }

    /// Each type contains the next one a billion times.
    #[test]
    fn sizes_beyond_any_memory_are_measured_without_overflow() {
        let mut text = "T0[1000000000] x\n".to_owned();
        for depth in 0..20 {
            text += &format!("====\nMSG: a/T{depth}\nT{}[1000000000] x\n", depth + 1);
        }
        let end = |last: &str| format!("{text}====\nMSG: a/T20\n{last}");
        assert_eq!(parse(&end("int8 x"), Dialect::Ros1).unwrap().messages[0].min_bytes, usize::MAX);
        assert_eq!(parse(&end(""), Dialect::Ros1).unwrap().messages[0].min_bytes, 0);
    }
}
