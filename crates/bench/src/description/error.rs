//! Errors of a bench description.

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
    /// The text is no bench description.
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
    /// A value is outside the range of the model.
    #[error("{file}: {field} is {found}; expected {expected}")]
    OutOfRange {
        /// Path or preset.
        file: String,
        /// Dotted name of the field.
        field: String,
        /// Value found.
        found: String,
        /// Values allowed.
        expected: String,
    },
}
