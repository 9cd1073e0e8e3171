//! Errors of a bench description.

use std::fmt::Write as _;

/// Field, value found and value expected of an entry that is not allowed.
pub type Refusal = (String, String, String);

/// Wrong or missing entry of a description.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Flaw {
    /// Line in the file, from 1; none if the entry has no place there.
    pub line: Option<usize>,
    /// Dotted name of the field.
    pub field: String,
    /// Content found, as it completes "the field is ...".
    pub found: String,
    /// Content expected.
    pub expected: String,
}

impl std::fmt::Display for Flaw {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if let Some(line) = self.line {
            write!(f, "line {line}: ")?;
        }
        write!(f, "{} is {}; expected {}", self.field, self.found, self.expected)
    }
}

/// Error of a bench description.
#[derive(Debug, thiserror::Error)]
pub enum DescriptionError {
    /// The file could not be read.
    #[error("{file}: cannot be read: {source}")]
    Unreadable {
        /// Path given.
        file: String,
        /// Cause.
        source: std::io::Error,
    },
    /// The text is no TOML.
    #[error("{file}: {message}")]
    Malformed {
        /// Path or preset.
        file: String,
        /// Line, column, content found and content expected.
        message: String,
    },
    /// The description is of another plant than the caller needs.
    #[error("{file}: found plant `{found}`; expected `{expected}`")]
    OtherPlant {
        /// Path or preset.
        file: String,
        /// Plant of the description.
        found: &'static str,
        /// Plant that the caller needs.
        expected: &'static str,
    },
    /// Entries are wrong or missing; all of them are listed.
    #[error("{}", list(file, flaws))]
    Flawed {
        /// Path or preset.
        file: String,
        /// Wrong and missing entries, in the order of the lines.
        flaws: Vec<Flaw>,
    },
}

/// Formats one flaw on the line of the file, several on a line each.
fn list(file: &str, flaws: &[Flaw]) -> String {
    if let [flaw] = flaws {
        return format!("{file}: {flaw}");
    }
    let mut text = format!("{file}: {} entries are wrong or missing", flaws.len());
    for flaw in flaws {
        let _ = write!(text, "\n  {flaw}");
    }
    text
}
