//! A unit as a file: a ZIP archive of model description, libraries and resources.

use crate::model::{DESCRIPTION, Model, SETTINGS, Settings, USE_NETWORKS, image_file};
use crate::xml::{MODEL_IDENTIFIER, Version, description};
use sha2::{Digest, Sha256};
use std::io::{Cursor, Write};
use zip::write::SimpleFileOptions;

/// Library of the unit for one platform.
#[derive(Clone, Debug)]
pub struct Library {
    /// Operating system: that part of the folder's name.
    pub platform: Platform,
    /// Content of the file.
    pub bytes: Vec<u8>,
}

/// Platform of a library.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Platform {
    /// Linux on x86-64.
    Linux,
    /// Windows on x86-64.
    Windows,
}

impl Platform {
    /// Every platform.
    pub const ALL: [Self; 2] = [Self::Linux, Self::Windows];

    /// Folder in a unit of a version, as that of `cargo xtask fmu-library` for FMI 2.0.
    pub const fn folder(self, version: Version) -> &'static str {
        match (self, version) {
            (Self::Linux, Version::Two) => "linux64",
            (Self::Linux, Version::Three) => "x86_64-linux",
            (Self::Windows, Version::Two) => "win64",
            (Self::Windows, Version::Three) => "x86_64-windows",
        }
    }

    /// Name of the library's file in a unit.
    pub fn file(self) -> String {
        let ending = match self {
            Self::Linux => "so",
            Self::Windows => "dll",
        };
        format!("{MODEL_IDENTIFIER}.{ending}")
    }
}

/// Packs a model with its libraries. The same content gives the same bytes.
///
/// `files` are those that the description names, by their names in the resources.
pub fn pack(
    model: &Model,
    version: Version,
    libraries: &[Library],
    files: &[(String, Vec<u8>)],
    tool: &str,
) -> Result<Vec<u8>, String> {
    let text = model.bench().to_toml().map_err(|error| error.to_string())?;
    let mut resources = vec![(DESCRIPTION.to_owned(), text.into_bytes())];
    resources.extend(files.iter().cloned());
    let images = model.materials().into_iter().map(|m| (image_file(m), model.image(m).to_vec()));
    resources.extend(images);
    let mut entries = Vec::new();
    for library in libraries {
        let path = format!("binaries/{}/{}", library.platform.folder(version), library.platform.file());
        entries.push((path, library.bytes.clone()));
    }
    let guid = identifier(&description(model, version, "", tool), &resources, &entries);
    let xml = description(model, version, &guid, tool);
    let has_networks = model.variables().iter().any(|v| v.name == USE_NETWORKS && v.start != 0.0);
    let settings = Settings { kind: model.kind(), has_networks, guid, table: model.fingerprint() };
    let settings = toml::to_string(&settings).map_err(|error| error.to_string())?;
    resources.push((SETTINGS.to_owned(), settings.into_bytes()));
    entries.insert(0, ("modelDescription.xml".to_owned(), xml.into_bytes()));
    entries.extend(resources.into_iter().map(|(name, bytes)| (format!("resources/{name}"), bytes)));
    archive(&entries).map_err(|error| error.to_string())
}

/// Identifier of a unit from its content, in the form of a UUID.
fn identifier(xml: &str, resources: &[(String, Vec<u8>)], libraries: &[(String, Vec<u8>)]) -> String {
    let mut hash = Sha256::new();
    hash.update(xml);
    for (name, bytes) in resources.iter().chain(libraries) {
        hash.update(name);
        hash.update(bytes);
    }
    let digits: String = hash.finalize().iter().take(16).map(|byte| format!("{byte:02x}")).collect();
    let [a, b, c, d, e] = [0..8, 8..12, 12..16, 16..20, 20..32].map(|range| &digits[range]);
    format!("{{{a}-{b}-{c}-{d}-{e}}}")
}

fn archive(entries: &[(String, Vec<u8>)]) -> zip::result::ZipResult<Vec<u8>> {
    let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (path, bytes) in entries {
        let mode = if path.starts_with("binaries/") { 0o755 } else { 0o644 };
        writer.start_file(path, SimpleFileOptions::DEFAULT.unix_permissions(mode))?;
        writer.write_all(bytes)?;
    }
    Ok(writer.finish()?.into_inner())
}
