//! Types of fields.

use toml::Value;

/// Choice between two valid values of a field that is missing or wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Placeholder {
    Low,
    High,
}

/// Type of a field's value.
#[derive(Clone, Copy, Debug)]
pub enum FieldKind {
    /// Number; an integer is accepted too.
    Number,
    /// Integer.
    Integer,
    /// `true` or `false`.
    Switch,
    /// One of the names.
    Name(fn() -> Vec<&'static str>),
    /// Name of a column of a log, its index from 0, or an expression of columns.
    Column,
    /// Table with a number for each channel.
    NumberPerChannel,
    /// List of pairs of numbers.
    Points,
    /// Free text that is not empty.
    Text,
    /// Two numbers, `[x, y]`.
    Pair,
}

impl FieldKind {
    /// Values allowed, as a noun.
    pub fn describe(self) -> String {
        match self {
            Self::Number => "a number".into(),
            Self::Integer => "an integer".into(),
            Self::Switch => "true or false".into(),
            Self::Name(names) => format!("one of {}", names().join(", ")),
            Self::Column => "the name of a column, an expression of columns, or an index from 0".into(),
            Self::NumberPerChannel => "a number for each channel".into(),
            Self::Points => "a list of pairs of numbers, [[0.0, 1.0], [2.0, 3.0]]".into(),
            Self::Text => "a text".into(),
            Self::Pair => "two numbers, [x, y]".into(),
        }
    }

    /// Returns whether the value is a table.
    pub(crate) const fn is_table(self) -> bool {
        matches!(self, Self::NumberPerChannel)
    }

    /// A valid value.
    pub(super) fn placeholder(self, range: Option<(f64, f64)>, which: Placeholder) -> Value {
        let is_low = which == Placeholder::Low;
        let (min, max) = range.unwrap_or((1.0, 2.0));
        let number = if is_low { min } else { max };
        match self {
            Self::Number => Value::Float(number),
            Self::Integer => Value::Integer(number as i64),
            Self::Switch => Value::Boolean(is_low),
            Self::Name(names) => {
                let names = names();
                let name = if is_low { names.first() } else { names.last() };
                Value::String(name.copied().unwrap_or_default().into())
            }
            Self::Column => Value::Integer(0),
            Self::NumberPerChannel => Value::Table(toml::Table::new()),
            Self::Points => Value::Array(Vec::new()),
            Self::Text => Value::String(if is_low { "first" } else { "second" }.into()),
            Self::Pair => Value::Array(vec![Value::Float(number), Value::Float(number)]),
        }
    }
}

/// Formats a number for a message: plainly, or with a power of ten if that is shorter.
pub(crate) fn format_number(value: f64) -> String {
    if value == 0.0 || (1e-3..1e7).contains(&value.abs()) || !value.is_finite() {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}

/// Type of a field of a section.
pub trait FieldType {
    /// Type of the value in the description.
    const KIND: FieldKind;
    /// True if the field may be absent without a default.
    const IS_OPTION: bool = false;

    /// The value as text; empty if it is absent.
    fn text(&self) -> String;
}

impl FieldType for f64 {
    const KIND: FieldKind = FieldKind::Number;

    fn text(&self) -> String {
        format_number(*self)
    }
}

impl FieldType for u32 {
    const KIND: FieldKind = FieldKind::Integer;

    fn text(&self) -> String {
        self.to_string()
    }
}

impl FieldType for bool {
    const KIND: FieldKind = FieldKind::Switch;

    fn text(&self) -> String {
        self.to_string()
    }
}

impl FieldType for String {
    const KIND: FieldKind = FieldKind::Text;

    fn text(&self) -> String {
        self.clone()
    }
}

impl FieldType for Vec<[f64; 2]> {
    const KIND: FieldKind = FieldKind::Points;

    fn text(&self) -> String {
        let pairs = self.iter().map(|[a, b]| format!("[{}, {}]", format_number(*a), format_number(*b)));
        let pairs = pairs.collect::<Vec<_>>();
        if pairs.is_empty() { String::new() } else { format!("[{}]", pairs.join(", ")) }
    }
}

impl FieldType for [f64; 2] {
    const KIND: FieldKind = FieldKind::Pair;

    fn text(&self) -> String {
        let [x, y] = self.map(format_number);
        format!("[{x}, {y}]")
    }
}

impl<T: FieldType> FieldType for Option<T> {
    const KIND: FieldKind = T::KIND;
    const IS_OPTION: bool = true;

    fn text(&self) -> String {
        self.as_ref().map_or_else(String::new, FieldType::text)
    }
}

impl FieldType for contact::BearingMaterial {
    const KIND: FieldKind = FieldKind::Name(|| Self::ALL.map(Self::name).to_vec());

    fn text(&self) -> String {
        self.name().into()
    }
}

/// Implements [`FieldType`] for enumerations that serde writes by a name.
macro_rules! named_field {
    ($type:ty { $($variant:ident $name:literal),* $(,)? }) => {
        impl $crate::schema::FieldType for $type {
            const KIND: $crate::schema::FieldKind = $crate::schema::FieldKind::Name(|| vec![$($name),*]);

            fn text(&self) -> String {
                match self { $(Self::$variant => $name.into(),)* }
            }
        }
    };
}
pub(crate) use named_field;
