//! Files that are written completely or not at all.

use std::io::Write;
use std::path::Path;

/// Writes to a temporary file in the folder of `path` and renames it.
pub fn write(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let directory = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    std::fs::create_dir_all(directory)?;
    let mut file = tempfile::Builder::new().prefix(".pintle-").suffix(".tmp").tempfile_in(directory)?;
    file.write_all(bytes)?;
    // A temporary file is private by default; users expect an ordinary file.
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        file.as_file().set_permissions(std::fs::Permissions::from_mode(0o644))?;
    }
    file.persist(path).map_err(|e| e.error)?;
    Ok(())
}
