//! How a foreign log's columns become channels: the `[log]` table of a bench description.

use crate::channel::Channel;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The `[log]` table. The default reads the project's own CSV.
///
/// ```toml
/// [log]
/// separator = "whitespace"
/// header = false
/// time = { from = 0, scale = 1e-3 }
/// [log.columns]
/// position_m = { from = 4, scale = 1e-3 }
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LogFormat {
    /// What stands between two fields.
    #[serde(default)]
    pub separator: Separator,
    /// Whether the first line names the columns.
    #[serde(default = "yes")]
    pub header: Header,
    /// Where the time comes from; `t_s` by default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time: Option<Column>,
    /// Where each channel comes from; by default from the column of its own name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub columns: BTreeMap<Channel, Column>,
}

fn yes() -> Header {
    Header(true)
}

/// Whether a log has a header line; true by default.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Header(pub bool);

impl Default for Header {
    fn default() -> Self {
        yes()
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

/// One foreign column: `value = scale * field + offset`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Column {
    /// Header name, or index from 0 where there is no header.
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

impl LogFormat {
    /// Whether this is the project's own CSV.
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }
}
