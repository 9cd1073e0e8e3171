//! `model-quant generate c`: a model for programs in C or C++.

use crate::cli::checkpoint::{BearingParser, bearings};
use crate::cli::error::CliError;
use crate::cli::output::{print, print_json};
use crate::data::file_io::{check_directory, write_atomically};
use crate::exchange::c_package::{Libraries, files};
use crate::quantise::image::AlignedImage;
use inference::{BearingMaterial, Model, shipped};
use serde_json::json;
use std::path::PathBuf;

/// Write a model for programs in other languages
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    language: Language,
}

/// Language of the program.
#[derive(Debug, clap::Subcommand)]
enum Language {
    C(CArguments),
}

/// Write a folder for C and C++: header, static libraries, CMake package, example
///
/// include/pintle_model.h documents the interface. lib has the library of each platform, src the
/// images as C arrays, cmake the package `pintle-model` for find_package, example a program for the
/// host and for a Cortex-M4F. The library allocates nothing, needs no C library and gives the bits
/// of the Rust crate. Images with 8-bit activations (`--mode w8a8`) are refused.
///
/// The libraries come from a release archive, or from `cargo xtask c-library` in the workspace.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  model-quant generate c --out pintle-model\n  \
                  model-quant generate c new/babbitt.pintle --out pintle-model --json")]
struct CArguments {
    /// Model images, at most one for each bearing; default: the shipped ones
    #[arg(value_name = "IMAGE", conflicts_with = "bearing")]
    images: Vec<PathBuf>,
    /// Bearing material of the shipped image; all if not given
    #[arg(long, value_parser = BearingParser)]
    bearing: Option<BearingMaterial>,
    /// Folder with PLATFORM/libpintle_model.a; default: where the workspace or the archive has it
    #[arg(long, value_name = "DIR")]
    libraries: Option<PathBuf>,
    /// Output directory
    #[arg(long, value_name = "DIR", default_value = "pintle-model")]
    out: PathBuf,
    /// Print the files as JSON
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let Language::C(arguments) = &arguments.language;
    let folder = arguments.libraries.clone().unwrap_or_else(Libraries::default_folder);
    let libraries = Libraries::read(&folder)?;
    let platforms = libraries.platforms().join(", ");
    let images = read(arguments)?;
    let models = load(&images)?;
    check_directory(&arguments.out)?;
    let files = files(&models, libraries);
    for (path, bytes) in &files {
        write_atomically(&arguments.out.join(path), bytes)?;
    }
    if arguments.json {
        let paths: Vec<&String> = files.iter().map(|(path, _)| path).collect();
        return print_json(&json!({ "folder": arguments.out.display().to_string(), "files": paths }));
    }
    print(format_args!(
        "{}: {} files, libraries for {platforms}; README.md says how to use them",
        arguments.out.display(),
        files.len()
    ))
}

/// Image with its path in messages.
type NamedImage = (PathBuf, AlignedImage);

/// Reads the images, or copies the shipped ones.
fn read(arguments: &CArguments) -> Result<Vec<NamedImage>, CliError> {
    if arguments.images.is_empty() {
        let copy = |bearing: BearingMaterial| (bearing.name().into(), AlignedImage::copy(shipped(bearing)));
        return Ok(bearings(arguments.bearing).into_iter().map(copy).collect());
    }
    let read = |path: &PathBuf| match AlignedImage::read(path) {
        Ok(image) => Ok((path.clone(), image)),
        Err(source) => Err(CliError::Read { path: path.clone(), source }),
    };
    arguments.images.iter().map(read).collect()
}

/// Checks the images, and that there is at most one for each bearing.
fn load(images: &[NamedImage]) -> Result<Vec<(&[u8], Model<'_>)>, CliError> {
    let mut models: Vec<(&[u8], Model<'_>)> = Vec::new();
    for (path, image) in images {
        let model = Model::load(image).map_err(|source| CliError::Image { path: path.clone(), source })?;
        let bearing = model.header().bearing;
        if models.iter().any(|(_, other)| other.header().bearing == bearing) {
            let found = format!("a second image for the {} bearing: {}", bearing.name(), path.display());
            return Err(CliError::Argument("IMAGE", found, "at most one for each bearing"));
        }
        models.push((image, model));
    }
    Ok(models)
}
