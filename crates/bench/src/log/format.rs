//! Format of a foreign log: the `[log]` and `[columns]` tables of a bench description.

use crate::signals::Channel;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Name of the time column, and its key in `[columns]`.
pub const TIME: &str = "t_s";

/// Source of each signal, by the signal's name. A signal that is not listed is read from the column
/// with its own name.
pub type Columns = BTreeMap<String, Column>;

/// Format of a log. The default is the project's own CSV.
///
/// ```toml
/// [log]
/// separator = "whitespace"
/// header = false
///
/// [columns]
/// t_s = { from = 0, scale = 1e-3 }
/// spindle_angle_rad = { from = "qm", scale = 0.0174533 }
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LogFormat {
    /// The `[log]` table.
    pub text: TextFormat,
    /// The `[columns]` table.
    pub columns: Columns,
}

/// The `[log]` table: how a line is split into fields.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TextFormat {
    /// Separator between two fields.
    pub separator: Separator,
    /// True if the first line names the columns.
    pub header: bool,
}

impl Default for TextFormat {
    fn default() -> Self {
        Self { separator: Separator::Comma, header: true }
    }
}

impl TextFormat {
    /// Returns whether this is the project's own CSV.
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// Field separator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Separator {
    /// `,`
    Comma,
    /// `;`
    Semicolon,
    /// One tab.
    Tab,
    /// Any run of blanks and tabs.
    Whitespace,
}

/// One foreign column: `value = scale * field + offset`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Column {
    /// Header name, or index from 0 without a header.
    pub from: ColumnId,
    /// Factor to SI.
    #[serde(default = "one")]
    pub scale: f64,
    /// Offset in SI, added after the factor.
    #[serde(default)]
    pub offset: f64,
}

/// A foreign column by name or by index.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum ColumnId {
    /// Index from 0.
    Index(usize),
    /// Header name.
    Name(String),
}

fn one() -> f64 {
    1.0
}

/// Returns the first key that is neither the time nor a channel.
pub fn unknown_column(columns: &Columns) -> Option<&str> {
    columns.keys().map(String::as_str).find(|&name| name != TIME && Channel::from_name(name).is_none())
}
