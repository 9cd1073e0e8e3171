//! Errors of reading a log.

/// Error of reading or writing a log.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The file could not be read or written.
    #[error("{file}: {source}")]
    Io {
        /// Path.
        file: String,
        /// Cause.
        source: std::io::Error,
    },
    /// A field has an unexpected content.
    #[error("{file}: {place}, {column}: found {found}; expected {expected}")]
    Field {
        /// Path.
        file: String,
        /// Line of a text, row of a table or element of a variable, from 1.
        place: String,
        /// Column by name or index.
        column: String,
        /// Content found.
        found: String,
        /// Content expected.
        expected: &'static str,
    },
    /// Columns that the description names are missing, or their expressions are wrong; all of them
    /// are listed.
    #[error("{}", list(file, flaws))]
    Columns {
        /// Path.
        file: String,
        /// Entry of `[columns]`, content found and content expected.
        flaws: Vec<String>,
    },
    /// The log lacks a required part.
    #[error("{file}: {found}; expected {expected}")]
    Content {
        /// Path.
        file: String,
        /// Content found.
        found: String,
        /// Content expected.
        expected: String,
    },
}

/// Formats one flaw on the line of the file, several on a line each.
fn list(file: &str, flaws: &[String]) -> String {
    match flaws {
        [flaw] => format!("{file}: {flaw}"),
        flaws => format!("{file}: {} columns cannot be read\n  {}", flaws.len(), flaws.join("\n  ")),
    }
}

impl LogError {
    /// Returns the error of a file or of one of its columns.
    pub(super) fn content(file: &str, found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self::Content { file: file.into(), found: found.into(), expected: expected.into() }
    }

    /// Message about a column without the names of file, column and purpose.
    pub(super) fn reason(&self, wanted: &str) -> String {
        match self {
            Self::Io { source, .. } => source.to_string(),
            Self::Field { place, found, expected, .. } => {
                format!("found {found} at {place}; expected {expected}")
            }
            Self::Columns { flaws, .. } => flaws.join("; "),
            Self::Content { found, .. } => {
                let reason = found.split_once(&format!(" for {wanted}: "));
                reason.map_or(found.as_str(), |(_, reason)| reason).to_owned()
            }
        }
    }
}
