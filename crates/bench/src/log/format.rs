//! Format of a foreign log: the `[log]` and `[columns]` tables of a bench description.

use crate::schema::{FieldKind, FieldType, named_field, section};
use crate::signals::Channel;
use serde::{Deserialize, Deserializer, Serialize};
use std::collections::BTreeMap;

/// Name of the time column, and its key in `[columns]`.
pub const TIME: &str = "t_s";
/// Unit of the time column.
pub(super) const TIME_UNIT: &str = "s";

/// Source of each signal, by the signal's name. A signal that is not listed is read from the column
/// with its own name.
pub type Columns = BTreeMap<String, Column>;

/// Format of a log. By default the text format is detected, and the columns have the names of
/// channels.
///
/// ```toml
/// [log]
/// separator = "whitespace"
/// header = false
///
/// [columns]
/// t_s = { from = 0, scale = 1e-3 }
/// spindle_angle_rad = { from = "qm", scale = 0.0174533 }
/// drive_torque_nm = "(p_a - p_b) * 4.9e-4"
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LogFormat {
    /// The `[log]` table; the format is detected without one.
    pub text: Option<TextFormat>,
    /// The `[columns]` table.
    pub columns: Columns,
}

section! {
    /// The `[log]` table: how a line is split into fields.
    #[derive(Copy, Eq)]
    TextFormat {
        /// Separator between two fields.
        #[serde(default)]
        separator: Separator,
        /// True if the first line names the columns; a line of units may follow.
        #[serde(default = "yes")]
        header: bool,
        /// True if numbers are written with a decimal comma; the separator is another one then.
        #[serde(default, skip_serializing_if = "is_false")]
        decimal_comma: bool,
    }
}

impl Default for TextFormat {
    fn default() -> Self {
        Self { separator: Separator::Comma, header: true, decimal_comma: false }
    }
}

impl TextFormat {
    /// Lines of the `[log]` table.
    pub fn lines(&self) -> Vec<String> {
        let mut lines = vec![format!("separator = {:?}", self.separator.text())];
        if !self.header {
            lines.push("header = false".into());
        }
        if self.decimal_comma {
            lines.push("decimal_comma = true".into());
        }
        lines
    }

    /// Returns whether this is the project's own CSV.
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// Field separator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Separator {
    /// `,`
    #[default]
    Comma,
    /// `;`
    Semicolon,
    /// One tab.
    Tab,
    /// Any run of blanks and tabs.
    Whitespace,
}

named_field!(Separator {
    Comma "comma", Semicolon "semicolon", Tab "tab", Whitespace "whitespace"
});

section! {
    /// One foreign column: `value = scale * field + offset`. A text in place of the table is its
    /// `from`.
    Column {
        /// Header name, expression of columns, or index from 0.
        from: ColumnId,
        /// Factor to SI.
        #[serde(default = "one")]
        scale: f64 [-1e30, 1e30, "the signal's per column's"],
        /// Offset in SI, added after the factor.
        #[serde(default)]
        offset: f64 [-1e30, 1e30, "the signal's"],
    }
}

impl From<String> for Column {
    fn from(text: String) -> Self {
        Self { from: ColumnId::Name(text), scale: 1.0, offset: 0.0 }
    }
}

/// An entry of `[columns]` as written.
#[derive(Deserialize)]
#[serde(untagged)]
enum ColumnEntry {
    Text(String),
    Table(Column),
}

/// Reads the `[columns]` table, in which a text stands for a table with `from`.
pub(crate) fn columns<'de, D: Deserializer<'de>>(table: D) -> Result<Columns, D::Error> {
    let entries = BTreeMap::<String, ColumnEntry>::deserialize(table)?;
    let column = |entry| match entry {
        ColumnEntry::Text(text) => Column::from(text),
        ColumnEntry::Table(column) => column,
    };
    Ok(entries.into_iter().map(|(name, entry)| (name, column(entry))).collect())
}

/// A foreign column by name or by index, or an expression of columns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum ColumnId {
    /// Index from 0.
    Index(usize),
    /// Header name; any other text is an expression.
    Name(String),
}

impl FieldType for ColumnId {
    const KIND: FieldKind = FieldKind::Column;

    fn text(&self) -> String {
        match self {
            Self::Index(index) => index.to_string(),
            Self::Name(name) => name.clone(),
        }
    }
}

fn one() -> f64 {
    1.0
}

fn yes() -> bool {
    true
}

fn is_false(value: &bool) -> bool {
    !value
}

/// Returns whether a key of `[columns]` is the time or a channel.
pub fn is_signal(name: &str) -> bool {
    name == TIME || Channel::from_name(name).is_some()
}
