//! Files that are either whole or not there: written beside their place, then renamed.

use std::io;
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A file or directory that could not be written.
#[derive(Debug, thiserror::Error)]
#[error("{}: {source}", path.display())]
pub struct WriteError {
    /// The file or directory.
    pub path: PathBuf,
    /// What the system said.
    pub source: io::Error,
}

/// Writes a file through a temporary one in the same directory, which is created if it is missing.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    bench::atomic::write(path, bytes).map_err(|source| WriteError { path: path.to_path_buf(), source })
}

/// A temporary file beside a path, whose directory is created if it is missing. Only its owner can read it.
///
/// # Errors
///
/// What the system says.
pub fn temporary(path: &Path) -> io::Result<NamedTempFile> {
    let directory = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    std::fs::create_dir_all(directory)?;
    tempfile::Builder::new().prefix(".pintle-").suffix(".tmp").tempfile_in(directory)
}

/// Makes sure that files can be written into a directory, or into what is there of the way to it: before long work, not after it.
///
/// # Errors
///
/// What the system says.
pub fn check_directory(directory: &Path) -> Result<(), WriteError> {
    let there = directory.ancestors().find(|place| place.exists()).unwrap_or(Path::new("."));
    let probe = tempfile::Builder::new().prefix(".pintle-").suffix(".tmp").tempfile_in(there);
    probe.map(drop).map_err(|source| WriteError { path: directory.to_path_buf(), source })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_file_is_replaced_whole_and_leaves_nothing_else_behind() {
        let directory = tempfile::tempdir().expect("directory");
        let path = directory.path().join("deep").join("file");
        write_whole(&path, b"first").expect("first");
        write_whole(&path, b"second").expect("second");
        assert_eq!(fs::read(&path).expect("file"), b"second");
        assert_eq!(fs::read_dir(path.parent().expect("parent")).expect("entries").count(), 1);
        assert!(write_whole(directory.path(), b"a directory is in the way").is_err());
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
