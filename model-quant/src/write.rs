//! Files that are either whole or not there: written beside their place, then renamed.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

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
    let failed = |path: &Path| {
        let path = path.to_path_buf();
        move |source| WriteError { path, source }
    };
    if let Some(directory) = path.parent() {
        fs::create_dir_all(directory).map_err(failed(directory))?;
    }
    let mut temporary = path.as_os_str().to_owned();
    temporary.push(format!(".{}.tmp", std::process::id()));
    let temporary = PathBuf::from(temporary);
    let written = fs::write(&temporary, bytes).and_then(|()| fs::rename(&temporary, path));
    if written.is_err() {
        // The temporary file may not exist; what matters is that none is left behind.
        let _ = fs::remove_file(&temporary);
    }
    written.map_err(failed(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_whole_and_leaves_nothing_else_behind() {
        let directory = tempfile::tempdir().expect("directory");
        let path = directory.path().join("deep").join("file");
        write_whole(&path, b"first").expect("first");
        write_whole(&path, b"second").expect("second");
        assert_eq!(fs::read(&path).expect("file"), b"second");
        assert_eq!(fs::read_dir(path.parent().expect("parent")).expect("entries").count(), 1);
        assert!(write_whole(directory.path(), b"a directory is in the way").is_err());
        assert_eq!(fs::read_dir(directory.path()).expect("entries").count(), 1);
    }
}
