//! Fields of a bench description as data: name, type, unit, range, default and meaning.
//!
//! `section!` defines a section of a description and its entries here in one place. The checks of a
//! description, the template that `describe` writes and `docs/description.md` read the entries.
//!
//! The unit is the suffix of a field's name, unless the field states another one. A range is far
//! beyond any machine: it protects the model from overflow. Ranges that depend on other fields are
//! checked by the plant.

mod field_type;
mod units;

pub use field_type::{FieldKind, FieldType};
pub(crate) use field_type::{Placeholder, format_number, named_field};

/// Unit of a number by the suffix of its name; empty if the name has no unit.
pub fn unit_of_name(name: &str) -> &'static str {
    units::of_name(name)
}

/// Lower bound for values that must be above 0.
pub(crate) const TINY: f64 = 1e-12;
/// Upper bound far beyond any machine. It protects the model from overflow.
pub(crate) const HUGE: f64 = 1e12;

/// Defines a section of a description: a struct that is read and written, and its [`FieldEntry`]s.
///
/// A field is `name: Type [minimum, maximum, "unit"],`. The brackets, or the unit in them, may be
/// left out.
macro_rules! section {
    ($(#[$meta:meta])* $name:ident {
        $($(#[$field_meta:meta])* $field:ident : $type:ty $([$min:expr, $max:expr $(, $unit:literal)?])?,)*
    }) => {
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct $name { $($(#[$field_meta])* pub $field: $type,)* }

        impl $crate::schema::Section for $name {
            const FIELDS: &'static [$crate::schema::FieldEntry] = &[$(
                $crate::schema::FieldEntry {
                    name: stringify!($field),
                    attributes: &[$(stringify!($field_meta)),*],
                    kind: <$type as $crate::schema::FieldType>::KIND,
                    is_option: <$type as $crate::schema::FieldType>::IS_OPTION,
                    range: $crate::schema::first(&[$(($min, $max))?]),
                    own_unit: $crate::schema::first_text(&[$($($unit)?)?]),
                },
            )*];

            fn values(&self) -> Vec<(&'static str, String)> {
                vec![$((stringify!($field), $crate::schema::FieldType::text(&self.$field))),*]
            }
        }
    };
}
pub(crate) use section;

/// Returns the only range, if there is one.
pub(crate) const fn first(ranges: &[(f64, f64)]) -> Option<(f64, f64)> {
    match ranges {
        [range, ..] => Some(*range),
        [] => None,
    }
}

/// Returns the only text, if there is one.
pub(crate) const fn first_text(texts: &[&'static str]) -> Option<&'static str> {
    match texts {
        [text, ..] => Some(text),
        [] => None,
    }
}

/// Field of a section.
#[derive(Clone, Copy, Debug)]
pub struct FieldEntry {
    /// Name in the section.
    pub name: &'static str,
    /// Attributes of the field as written: documentation and default.
    pub(crate) attributes: &'static [&'static str],
    /// Type of the value.
    pub kind: FieldKind,
    pub(crate) is_option: bool,
    /// Minimum and maximum of a number.
    pub range: Option<(f64, f64)>,
    pub(crate) own_unit: Option<&'static str>,
}

impl FieldEntry {
    /// Returns whether a description must have the field.
    pub fn is_required(&self) -> bool {
        let has_default = |a: &&str| a.starts_with("serde") && a.contains("default");
        !self.is_option && !self.attributes.iter().any(has_default)
    }

    /// Meaning, from the documentation of the field.
    pub fn meaning(&self) -> String {
        meaning(self.attributes)
    }

    /// Unit of a number; empty if it has none.
    pub fn unit(&self) -> &'static str {
        self.own_unit.unwrap_or_else(|| units::of_name(self.name))
    }

    /// Values allowed, with the unit: `a number, 0 to 10 s`.
    pub fn expected(&self) -> String {
        let kind = self.kind.describe();
        match self.range_words() {
            Some(range) => format!("{kind}, {range}"),
            None if self.unit().is_empty() => kind,
            None => format!("{kind} in {}", self.unit()),
        }
    }

    /// Range of a number with its unit: `0 to 10 s`.
    pub(crate) fn range_words(&self) -> Option<String> {
        let (min, max) = self.range?;
        let range = format!("{} to {} {}", format_number(min), format_number(max), self.unit());
        Some(range.trim_end().into())
    }
}

/// Text of documentation attributes, one paragraph.
pub(crate) fn meaning(attributes: &[&str]) -> String {
    let line = |a: &&str| {
        // A long attribute is broken after the sign.
        let text = a.strip_prefix("doc")?.trim_start().strip_prefix('=')?.trim();
        let text = text.trim_start_matches('r').trim_matches('#');
        let text = text.strip_prefix('"')?.strip_suffix('"')?;
        Some(text.replace("\\\"", "\"").replace("\\'", "'").trim().to_owned())
    };
    attributes.iter().filter_map(line).collect::<Vec<_>>().join(" ")
}

/// A section of a description with its fields.
pub trait Section: Sized + serde::de::DeserializeOwned {
    /// Fields in the order of the struct.
    const FIELDS: &'static [FieldEntry];

    /// Values of all fields as text.
    fn values(&self) -> Vec<(&'static str, String)>;

    /// Values of all fields of a section in which only the required fields are given. Those of
    /// required fields are placeholders.
    fn defaults() -> Vec<(&'static str, String)> {
        let table = placeholders(Self::FIELDS, Placeholder::Low);
        table.try_into::<Self>().map(|section| section.values()).unwrap_or_default()
    }
}

impl Placeholder {
    /// A valid value of a field.
    pub(crate) fn value(self, field: &FieldEntry) -> toml::Value {
        field.kind.placeholder(field.range, self)
    }
}

/// The required fields of a section with valid values.
pub(crate) fn placeholders(fields: &[FieldEntry], which: Placeholder) -> toml::Table {
    let required = fields.iter().filter(|f| f.is_required());
    required.map(|f| (f.name.to_owned(), which.value(f))).collect()
}

/// Content of a plant's own top-level entry: a section, an optional one, or the plant's name.
pub(crate) trait Content {
    const FIELDS: &'static [FieldEntry];
    const IS_REQUIRED: bool = true;
    const SHAPE: Shape = Shape::Table;

    fn defaults() -> Vec<(&'static str, String)>;
}

impl<S: Section> Content for S {
    const FIELDS: &'static [FieldEntry] = S::FIELDS;

    fn defaults() -> Vec<(&'static str, String)> {
        S::defaults()
    }
}

impl<S: Section> Content for Option<S> {
    const FIELDS: &'static [FieldEntry] = S::FIELDS;
    const IS_REQUIRED: bool = false;

    fn defaults() -> Vec<(&'static str, String)> {
        S::defaults()
    }
}

impl<S: Section> Content for Vec<S> {
    const FIELDS: &'static [FieldEntry] = S::FIELDS;
    const IS_REQUIRED: bool = false;
    const SHAPE: Shape = Shape::Entries;

    fn defaults() -> Vec<(&'static str, String)> {
        S::defaults()
    }
}

impl Content for String {
    const FIELDS: &'static [FieldEntry] = &[];

    fn defaults() -> Vec<(&'static str, String)> {
        Vec::new()
    }
}

/// Form of a section.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A table with the fields: `[name]`.
    Table,
    /// A table with the fields for each channel: `[name.<channel>]`.
    PerChannel,
    /// A table with the fields for the time and for each channel.
    PerSignal,
    /// A number for each dotted parameter name.
    PerParameter,
    /// Entries of `[[effects]]`.
    Effects,
    /// Any number of tables with the fields: `[[name]]`.
    Entries,
}

/// Section of a plant's description.
#[derive(Clone, Debug)]
pub struct SectionEntry {
    /// Name in the description.
    pub name: &'static str,
    /// Meaning, one paragraph.
    pub meaning: String,
    /// Form.
    pub shape: Shape,
    /// True if a description must have it.
    pub is_required: bool,
    /// Fields; empty where names are free.
    pub fields: &'static [FieldEntry],
    defaults: fn() -> Vec<(&'static str, String)>,
}

impl SectionEntry {
    pub(crate) fn new<C: Content>(name: &'static str, meaning: String, shape: Shape) -> Self {
        let is_required = C::IS_REQUIRED && shape == Shape::Table;
        Self { name, meaning, shape, is_required, fields: C::FIELDS, defaults: C::defaults }
    }

    /// The same section as one that a description may leave out.
    pub(crate) fn optional(self) -> Self {
        Self { is_required: false, ..self }
    }

    /// Default of a field as text; none if it is required or absent by default.
    pub fn default_of(&self, field: &FieldEntry) -> Option<String> {
        let found = (self.defaults)().into_iter().find(|(name, _)| *name == field.name)?.1;
        (!field.is_required() && !found.is_empty()).then_some(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    section! {
        /// A section.
        #[allow(unreachable_pub, reason = "the macro defines sections for other crates")]
        Sample {
            /// Length of the "long" side.
            /// It is long.
            length_m: f64 [TINY, 10.0],
            /// Strength of the spring.
            strength: f64 [0.0, 1.0, "N or N m"],
            /// Number of them.
            #[serde(default = "three")]
            count: u32 [1.0, 9.0],
            /// Anything.
            free: Option<f64>,
        }
    }

    fn three() -> u32 {
        3
    }

    #[test]
    fn a_section_lists_its_fields_as_they_are_written() {
        let [length, strength, count, free] = <Sample as Section>::FIELDS else { panic!() };
        assert_eq!(length.meaning(), "Length of the \"long\" side. It is long.");
        assert_eq!(length.expected(), "a number, 1e-12 to 10 m");
        assert_eq!(strength.expected(), "a number, 0 to 1 N or N m");
        assert_eq!(count.expected(), "an integer, 1 to 9");
        assert_eq!(free.expected(), "a number");
        let required: Vec<bool> = <Sample as Section>::FIELDS.iter().map(FieldEntry::is_required).collect();
        assert_eq!(required, [true, true, false, false]);
    }

    #[test]
    fn a_default_is_what_reading_gives_without_the_field() {
        let entry = SectionEntry::new::<Sample>("sample", meaning(&["doc = \" A section.\""]), Shape::Table);
        let defaults: Vec<Option<String>> = entry.fields.iter().map(|f| entry.default_of(f)).collect();
        assert_eq!(defaults, [None, None, Some("3".into()), None]);
        assert_eq!((entry.meaning.as_str(), entry.is_required), ("A section.", true));
    }
}
