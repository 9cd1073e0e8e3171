//! Static libraries of the crate `c-interface`, one for each platform: where they are found.

use std::path::{Path, PathBuf};

/// File of the folder: path with `/`, and content.
pub(crate) type PackageFile = (String, Vec<u8>);

/// File of a library in the folder of its platform.
const FILE: &str = "libpintle_model.a";
/// Folder of the platforms in cargo's target folder and in a release archive.
const FOLDERS: [&str; 2] = ["c-libraries", "share/pintle/c-libraries"];

/// Libraries by platform, sorted.
#[derive(Debug)]
pub(crate) struct Libraries(Vec<(String, Vec<u8>)>);

/// Reason why there are no libraries.
#[derive(Debug, thiserror::Error)]
pub(crate) enum LibrariesError {
    #[error("{}: found no PLATFORM/{FILE}; `cargo xtask c-library` builds them", .0.display())]
    Missing(PathBuf),
    #[error("{}: {source}", path.display())]
    Unreadable { path: PathBuf, source: std::io::Error },
}

impl Libraries {
    /// Path of the libraries: where `cargo xtask c-library` puts them in cargo's target folder
    /// below the current directory, else beside this program, in a target folder or an archive.
    pub(crate) fn default_folder() -> PathBuf {
        let target = std::env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into());
        let here = Path::new(&target).join("c-libraries");
        let program = std::env::current_exe().unwrap_or_default();
        let mut beside = program.ancestors().skip(1).flat_map(|folder| FOLDERS.map(|tail| folder.join(tail)));
        if here.exists() { here } else { beside.find(|folder| folder.exists()).unwrap_or(here) }
    }

    /// Reads the library of every platform in a folder.
    pub(crate) fn read(folder: &Path) -> Result<Self, LibrariesError> {
        let unreadable = |path: &Path| {
            let path = path.to_owned();
            move |source| LibrariesError::Unreadable { path, source }
        };
        let mut libraries = Vec::new();
        let entries = match std::fs::read_dir(folder) {
            Ok(entries) => entries,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                return Err(LibrariesError::Missing(folder.to_owned()));
            }
            Err(error) => return Err(unreadable(folder)(error)),
        };
        for entry in entries {
            let entry = entry.map_err(unreadable(folder))?;
            let path = entry.path().join(FILE);
            if path.is_file() {
                let bytes = std::fs::read(&path).map_err(unreadable(&path))?;
                libraries.push((entry.file_name().to_string_lossy().into_owned(), bytes));
            }
        }
        libraries.sort();
        if libraries.is_empty() {
            Err(LibrariesError::Missing(folder.to_owned()))
        } else {
            Ok(Self(libraries))
        }
    }

    /// Names of the platforms: Rust's target triples.
    pub(crate) fn platforms(&self) -> Vec<&str> {
        self.0.iter().map(|(platform, _)| platform.as_str()).collect()
    }

    /// Returns the libraries as files of a package.
    pub(super) fn into_files(self) -> impl Iterator<Item = PackageFile> {
        self.0.into_iter().map(|(platform, bytes)| (format!("lib/{platform}/{FILE}"), bytes))
    }
}

#[cfg(test)]
impl<const N: usize> From<[(String, Vec<u8>); N]> for Libraries {
    fn from(libraries: [(String, Vec<u8>); N]) -> Self {
        Self(libraries.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_platform_with_a_library_is_read_and_a_folder_without_any_is_refused() {
        let folder = tempfile::tempdir().expect("folder");
        let missing = |folder: &Path| match Libraries::read(folder) {
            Err(LibrariesError::Missing(found)) => found == folder,
            _ => false,
        };
        assert!(missing(folder.path()) && missing(&folder.path().join("none")));
        for platform in ["b", "a"] {
            std::fs::create_dir(folder.path().join(platform)).expect("platform");
            std::fs::write(folder.path().join(platform).join(FILE), platform).expect("library");
        }
        std::fs::create_dir(folder.path().join("empty")).expect("platform");
        let found = Libraries::read(folder.path()).expect("libraries");
        assert_eq!(found.0, [("a".to_owned(), b"a".to_vec()), ("b".to_owned(), b"b".to_vec())]);
        std::fs::write(folder.path().join("file"), "").expect("file");
        assert!(matches!(
            Libraries::read(&folder.path().join("file")),
            Err(LibrariesError::Unreadable { .. })
        ));
    }
}
