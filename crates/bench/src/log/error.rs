//! Why a log was refused.

/// Why a log was refused.
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
    /// A field is not what it should be.
    #[error("{file}: {place}, {column}: found {found}; expected {expected}")]
    Field {
        /// Path.
        file: String,
        /// Line of a text, row of a table, element of a variable; from 1.
        place: String,
        /// Column by name or index.
        column: String,
        /// What stands there.
        found: String,
        /// What may stand there.
        expected: &'static str,
    },
    /// The log as a whole lacks something.
    #[error("{file}: {found}; expected {expected}")]
    Content {
        /// Path.
        file: String,
        /// What was found.
        found: String,
        /// What is needed.
        expected: String,
    },
}

impl LogError {
    /// The refusal of a file or one of its columns as a whole.
    pub(super) fn content(file: &str, found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self::Content { file: file.into(), found: found.into(), expected: expected.into() }
    }
}
