//! Reading of JSON files and atomic writing: a file is complete or absent.

use serde::de::DeserializeOwned;
use std::io;
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A file or directory that could not be written.
#[derive(Debug, thiserror::Error)]
#[error("{}: {source}", path.display())]
pub struct WriteError {
    /// The file or directory.
    pub path: PathBuf,
    /// Error of the operating system.
    pub source: io::Error,
}

/// A file that cannot be read or has unexpected content.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// It cannot be read.
    #[error("{path}: {source}")]
    Read {
        /// The file.
        path: String,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// Its content differs from the expected format.
    #[error("{path}: found {found}; expected {expected}")]
    Content {
        /// The file.
        path: String,
        /// Content found, with its position.
        found: String,
        /// Content expected.
        expected: String,
    },
}

impl FileError {
    pub(crate) fn content(path: &Path, found: impl ToString, expected: impl ToString) -> Self {
        let (found, expected) = (found.to_string(), expected.to_string());
        Self::Content { path: path.display().to_string(), found, expected }
    }

    /// Reads a file as text.
    pub(crate) fn text(path: &Path) -> Result<String, Self> {
        std::fs::read_to_string(path)
            .map_err(|source| Self::Read { path: path.display().to_string(), source })
    }

    /// Parses a text as JSON.
    pub(crate) fn json<T: DeserializeOwned>(path: &Path, text: &str, expected: &str) -> Result<T, Self> {
        serde_json::from_str(text).map_err(|error| Self::content(path, error, expected))
    }
}

/// Writes a file through a temporary one in the same directory, which is created if it is missing.
pub(crate) fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    bench::atomic::write(path, bytes).map_err(|source| WriteError { path: path.to_path_buf(), source })
}

/// Creates a temporary file in the directory of a path, which is created if it is missing. Only the
/// owner can read it.
///
/// # Errors
///
/// The operating system's.
pub(crate) fn temporary(path: &Path) -> io::Result<NamedTempFile> {
    let directory = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    std::fs::create_dir_all(directory)?;
    tempfile::Builder::new().prefix(".pintle-").suffix(".tmp").tempfile_in(directory)
}

/// Checks that files can be written to a directory, or to its nearest existing parent. Called
/// before long work.
///
/// # Errors
///
/// The operating system's.
pub(crate) fn check_directory(directory: &Path) -> Result<(), WriteError> {
    let there = directory.ancestors().find(|place| place.exists()).unwrap_or(Path::new("."));
    let probe = tempfile::Builder::new().prefix(".pintle-").suffix(".tmp").tempfile_in(there);
    probe.map(drop).map_err(|source| WriteError { path: directory.to_path_buf(), source })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_file_is_replaced_atomically_and_no_temporary_file_remains() {
        let directory = tempfile::tempdir().expect("directory");
        let path = directory.path().join("deep").join("file");
        write_atomically(&path, b"first").expect("first");
        write_atomically(&path, b"second").expect("second");
        assert_eq!(fs::read(&path).expect("file"), b"second");
        assert_eq!(fs::read_dir(path.parent().expect("parent")).expect("entries").count(), 1);
        assert!(write_atomically(directory.path(), b"a directory is in the way").is_err());
        assert!(check_directory(&path).is_err() && check_directory(&path.join("below")).is_err());
        assert!(check_directory(&directory.path().join("deep")).is_ok());
        assert!(
            check_directory(&directory.path().join("new/new")).is_ok()
                && check_directory(Path::new("x")).is_ok()
        );
        assert_eq!(fs::read_dir(directory.path()).expect("entries").count(), 1);
        assert_eq!(fs::read_dir(path.parent().expect("parent")).expect("entries").count(), 1);
    }
}
