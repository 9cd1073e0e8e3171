//! Files that are written completely or not at all.

use std::io::Write;
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A file that is written but not yet at its path. Dropped, it leaves nothing.
#[derive(Debug)]
pub struct StagedFile {
    file: NamedTempFile,
    path: PathBuf,
}

impl StagedFile {
    /// Writes to a temporary file in the folder of `path`, which is created.
    ///
    /// # Errors
    ///
    /// The folder or the file cannot be written.
    pub fn write(path: &Path, bytes: &[u8]) -> std::io::Result<Self> {
        let directory = match path.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        std::fs::create_dir_all(directory)?;
        let mut builder = tempfile::Builder::new();
        builder.prefix(".pintle-").suffix(".tmp");
        // A temporary file is private by default; users expect an ordinary file under their umask.
        #[cfg(unix)]
        let builder = {
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(std::fs::Permissions::from_mode(0o666))
        };
        let mut file = builder.tempfile_in(directory)?;
        file.write_all(bytes)?;
        // Without it a loss of power after the renaming could leave an empty file.
        file.as_file().sync_all()?;
        Ok(Self { file, path: path.to_owned() })
    }

    /// Path of the finished file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Renames the file to its path.
    ///
    /// # Errors
    ///
    /// The path is a folder, or the file system refuses.
    pub fn publish(self) -> std::io::Result<()> {
        self.file.persist(&self.path).map_err(|e| e.error)?;
        Ok(())
    }
}

/// Writes to a temporary file in the folder of `path` and renames it.
///
/// # Errors
///
/// Those of [`StagedFile`].
pub fn write(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    StagedFile::write(path, bytes)?.publish()
}
