//! Export of a contact, a bench or a mechanism as a functional mock-up unit.

use super::libraries;
use crate::cli::error::CliError;
use bench::description::{CourseKind, CourseSection};
use bench::{BearingMaterial, Bench, atomic};
use inference::Model as Networks;
use pintle_fmu::{Causality, Kind, Model, Version, pack};
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};

/// Content of a unit and where it comes from.
pub(crate) struct Export<'a> {
    pub(crate) kind: Kind,
    pub(crate) version: Version,
    /// File or preset of the description, for the files that it names.
    pub(crate) described_in: &'a str,
    /// Start value of `use_networks`.
    pub(crate) has_networks: bool,
    /// Images that replace the shipped ones of their materials.
    pub(crate) images: &'a [PathBuf],
    /// Folder of the libraries; none for the default ones.
    pub(crate) libraries: Option<&'a Path>,
}

/// A unit that was written.
#[derive(Serialize, JsonSchema)]
pub(crate) struct Exported {
    /// File.
    fmu: String,
    /// Version of the interface.
    fmi: &'static str,
    /// Content: contact, bench or mechanism.
    unit: &'static str,
    /// Platforms, as folders of the unit.
    platforms: Vec<&'static str>,
    parameters: usize,
    inputs: Vec<String>,
    outputs: Vec<String>,
    /// Size of the file.
    bytes: usize,
}

impl fmt::Display for Exported {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}: unit `{}`, FMI {}, {}", self.fmu, self.unit, self.fmi, self.platforms.join(", "))?;
        writeln!(f, "{} parameters, {} bytes", self.parameters, self.bytes)?;
        writeln!(f, "inputs:  {}", self.inputs.join(" "))?;
        write!(f, "outputs: {}", self.outputs.join(" "))
    }
}

/// Writes a unit of a checked description.
pub(crate) fn write(mut bench: Bench, export: &Export<'_>, out: &Path) -> Result<Exported, CliError> {
    let folder = Path::new(export.described_in).parent().unwrap_or(Path::new("")).to_owned();
    let files = named_files(&mut bench, &folder)?;
    let images = export.images.iter().map(|path| image(path)).collect::<Result<Vec<_>, _>>()?;
    let given: Vec<BearingMaterial> = images.iter().map(|(material, _)| *material).collect();
    let refused = |reason: String| CliError::Input(format!("{}: {reason}", export.described_in));
    let model = Model::new(export.kind, bench, &folder, export.has_networks, images).map_err(refused)?;
    let materials = model.materials();
    if let Some(path) = export.images.iter().zip(&given).find(|(_, m)| !materials.contains(m)).map(|(p, _)| p)
    {
        return Err(CliError::Input(format!(
            "--image {}: found networks of another material; expected those of {}",
            path.display(),
            materials.iter().map(|material| material.name()).collect::<Vec<_>>().join(", ")
        )));
    }
    let libraries = libraries::read(export.libraries).map_err(CliError::Input)?;
    let tool = format!("host-sim {}", env!("CARGO_PKG_VERSION"));
    let unit = pack(&model, export.version, &libraries, &files, &tool).map_err(CliError::Work)?;
    atomic::write(out, &unit).map_err(|error| CliError::output(out, &error))?;
    let names = |wanted: &[Causality]| -> Vec<String> {
        let all = model.variables().iter().filter(|variable| wanted.contains(&variable.causality));
        all.map(|variable| variable.name.clone()).collect()
    };
    Ok(Exported {
        fmu: out.display().to_string(),
        fmi: export.version.name(),
        unit: export.kind.name(),
        platforms: libraries.iter().map(|library| library.platform.folder(export.version)).collect(),
        parameters: names(&[Causality::Fixed, Causality::Tunable]).len(),
        inputs: names(&[Causality::Input]),
        outputs: names(&[Causality::Output]),
        bytes: unit.len(),
    })
}

/// Reads the files that a description names, and names them as the unit's resources.
fn named_files(bench: &mut Bench, folder: &Path) -> Result<Vec<(String, Vec<u8>)>, CliError> {
    let Some(bench) = bench.transmission_mut() else { return Ok(Vec::new()) };
    let mut files = Vec::new();
    let mut take = |section: Option<&mut CourseSection>, name: &str| -> Result<(), CliError> {
        let Some(section) = section.filter(|s| s.kind == CourseKind::Log && !s.file.is_empty()) else {
            return Ok(());
        };
        let path = folder.join(&section.file);
        let bytes = std::fs::read(&path).map_err(|e| CliError::Input(format!("{}: {e}", path.display())))?;
        let ending = path.extension().map_or("csv".into(), |ending| ending.to_string_lossy());
        section.file = format!("{name}.{ending}");
        files.push((section.file.clone(), bytes));
        Ok(())
    };
    take(bench.drive_profile.as_mut(), "drive_profile")?;
    take(bench.load_profile.as_mut(), "load_profile")?;
    Ok(files)
}

/// Reads an image and its material.
fn image(path: &Path) -> Result<(BearingMaterial, Vec<u8>), CliError> {
    let refused = |reason: String| CliError::Input(format!("{}: {reason}", path.display()));
    let bytes = std::fs::read(path).map_err(|error| refused(error.to_string()))?;
    let aligned = pintle_fmu::aligned(&bytes);
    let networks: Networks<'_> = Networks::load(aligned).map_err(|error| refused(error.to_string()))?;
    Ok((networks.header().bearing, bytes))
}
