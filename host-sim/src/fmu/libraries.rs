//! Libraries of exported units, one for each platform: where they are found.

use pintle_fmu::{Library, Platform, Version};
use std::path::{Path, PathBuf};

/// Folder of the platforms in cargo's target folder and in a release archive.
const FOLDERS: [&str; 2] = ["fmu-libraries", "share/pintle/fmu-libraries"];
/// Library that cargo builds with this program, beside it or in `deps`.
const BUILT: [&str; 2] = ["libpintle_fmu.so", "deps/libpintle_fmu.so"];

/// Reads the libraries of a folder; without one where `cargo xtask fmu-library` puts them, in a
/// target folder or beside this program, else the library that was built with this program.
pub(super) fn read(folder: Option<&Path>) -> Result<Vec<Library>, String> {
    let found = folder.map_or_else(default_folder, |folder| Some(folder.to_owned()));
    if let Some(folder) = found {
        let mut libraries = Vec::new();
        for platform in Platform::ALL {
            let path = folder.join(platform.folder(Version::Two)).join(platform.file());
            if path.is_file() {
                libraries.push(Library { platform, bytes: bytes(&path)? });
            }
        }
        if libraries.is_empty() {
            let expected = Platform::ALL.map(|p| format!("{}/{}", p.folder(Version::Two), p.file()));
            return Err(format!("{}: found none of {}", folder.display(), expected.join(", ")));
        }
        return Ok(libraries);
    }
    let program = std::env::current_exe().unwrap_or_default();
    let built = program.ancestors().skip(1).take(2).flat_map(|folder| BUILT.map(|file| folder.join(file)));
    match built.into_iter().find(|path| path.is_file()) {
        Some(path) => Ok(vec![Library { platform: Platform::Linux, bytes: bytes(&path)? }]),
        None => {
            Err("found no library for units; `cargo xtask fmu-library` builds it, and --libraries names \
                     its folder"
                .into())
        }
    }
}

fn default_folder() -> Option<PathBuf> {
    let target = std::env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into());
    let here = Path::new(&target).join(FOLDERS[0]);
    let program = std::env::current_exe().unwrap_or_default();
    let beside = program.ancestors().skip(1).flat_map(|folder| FOLDERS.map(|tail| folder.join(tail)));
    std::iter::once(here).chain(beside).find(|folder| folder.is_dir())
}

fn bytes(path: &Path) -> Result<Vec<u8>, String> {
    std::fs::read(path).map_err(|error| format!("{}: {error}", path.display()))
}
