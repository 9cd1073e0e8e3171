//! `model-quant package`: one signed file with images and self-tests for a controller.

use super::key::read as read_key;
use crate::cli::error::CliError;
use crate::cli::output::{print, print_json};
use crate::data::file_io::write_atomically;
use crate::exchange::key::{DEVELOPMENT, digits, parse};
use crate::exchange::package::{Package, PackageProperties};
use crate::quantise::image::AlignedImage;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use inference::{BearingMaterial, shipped};
use model_package::{MAX_VERSION, board};
use serde_json::json;
use std::path::PathBuf;

/// Options that a package to show has already.
const SIGNING: [&str; 5] = ["images", "version", "may_be_older", "revoke_older_keys", "out"];

/// Sign model images for a controller
///
/// The package contains the images, a self-test for each (inputs with the networks' results), and
/// an ed25519 signature over everything. The controller repeats the self-test before it runs an
/// image. It accepts a package whose version is above every one that was installed before. A
/// package signed with `--may-be-older` is accepted at any time, so its owner can always go back to
/// it. A firmware may trust several keys; a package signed with a later one and
/// `--revoke-older-keys` ends the trust in those before it. The same inputs give the same bytes.
#[derive(Debug, clap::Args)]
#[command(
    visible_alias = "sign",
    after_help = "Examples:\n  model-quant package new/babbitt.pintle --version 4 --key bench.key \
                  --out babbitt-4.package\n  \
                  model-quant package new/babbitt.pintle new/plastic.pintle --version 5 --key bench.key \
                  --out both-5.package\n  \
                  model-quant package --show both-5.package"
)]
pub(crate) struct Arguments {
    /// Model images, at most one for each bearing; default: the shipped ones of both bearings
    #[arg(value_name = "IMAGE")]
    images: Vec<PathBuf>,
    /// Version of the model; it shuts out all lower ones
    #[arg(
        long,
        value_name = "N",
        required_unless_present = "show",
        value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_VERSION))
    )]
    version: Option<u32>,
    /// Board that the package is for
    #[arg(long, value_parser = board_code(), default_value = board::ALL[0].name)]
    board: u16,
    /// Let controllers install it over newer models
    #[arg(long)]
    may_be_older: bool,
    /// End the controllers' trust in the keys that their firmware lists before this one
    #[arg(long)]
    revoke_older_keys: bool,
    /// File with the secret key; the published development key if not given
    #[arg(long, value_name = "FILE")]
    key: Option<PathBuf>,
    /// Package file to write
    #[arg(long, value_name = "FILE", required_unless_present = "show")]
    out: Option<PathBuf>,
    /// Only print the content of a package
    #[arg(long, value_name = "FILE", conflicts_with_all = SIGNING)]
    show: Option<PathBuf>,
    /// Print as JSON
    #[arg(long)]
    json: bool,
}

/// Parses the name of a board into its code.
fn board_code() -> impl TypedValueParser<Value = u16> {
    let names = board::ALL.map(|board| PossibleValue::new(board.name).help(board.title));
    PossibleValuesParser::new(names).try_map(|name| {
        let board = board::ALL.iter().find(|board| board.name == name);
        board.map(|board| board.code).ok_or("unknown board")
    })
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let key = match &arguments.key {
        Some(path) => read_key(path)?,
        None => {
            parse(DEVELOPMENT).map_err(|source| CliError::Key { path: "development key".into(), source })?
        }
    };
    let public = key.verifying_key().to_bytes();
    let wrong = |path: &PathBuf| {
        let path = path.clone();
        move |source| CliError::Package { path, source }
    };
    let (path, package) = match (&arguments.show, &arguments.out, arguments.version) {
        (Some(path), ..) => {
            let read = Package::read(path).map_err(|source| CliError::Read { path: path.clone(), source })?;
            (path, read.map_err(wrong(path))?)
        }
        (None, Some(path), Some(version)) => {
            let properties = PackageProperties {
                board: arguments.board,
                version,
                may_be_older: arguments.may_be_older,
                revokes_older_keys: arguments.revoke_older_keys,
            };
            let package = Package::new(properties, &images(arguments)?, &key).map_err(wrong(path))?;
            write_atomically(path, &package.to_bytes())?;
            (path, package)
        }
        _ => return Ok(()),
    };
    let manifest = package.manifest;
    let signed = package.is_signed_for(&public);
    if arguments.json {
        let images: Vec<_> = package
            .images()
            .iter()
            .zip(manifest.samples.into_iter().filter(|&samples| samples > 0))
            .map(|((bearing, crc, header, bytes), samples)| {
                json!({ "bearing": bearing.name(), "crc": format!("{crc:08x}"), "bytes": bytes,
                        "self_test_samples": samples,
                        "training_id": format!("{:016x}", header.training_id) })
            })
            .collect();
        return print_json(&json!({
            "file": path.display().to_string(), "version": manifest.version,
            "board": format!("{:04x}", manifest.board),
            "may_be_older": manifest.may_be_older,
            "revokes_older_keys": manifest.revokes_older_keys, "bytes": package.to_bytes().len(),
            "hash": digits(&manifest.hash),
            "images": images, "signed_for": signed.then(|| digits(&public)),
        }));
    }
    print(format_args!("{}: {} bytes", path.display(), package.to_bytes().len()))?;
    print(format_args!(
        "  version   {}{}{}",
        manifest.version,
        if manifest.may_be_older { ", may be older" } else { "" },
        if manifest.revokes_older_keys { ", revokes older keys" } else { "" }
    ))?;
    print(format_args!("  board     {:#06x}", manifest.board))?;
    for (bearing, crc, header, bytes) in package.images() {
        let samples = manifest.samples.get(usize::from(bearing.code())).unwrap_or(&0);
        print(format_args!(
            "  {:<9} {bytes} bytes, crc {crc:08x}, training {:016x}, self-test of {samples} samples",
            bearing.name(),
            header.training_id
        ))?;
    }
    print(format_args!("  hash      {}", digits(&manifest.hash)))?;
    let development = parse(DEVELOPMENT).is_ok_and(|key| key.verifying_key().to_bytes() == public);
    let name = if development { "the published development key" } else { "this key" };
    print(format_args!(
        "  signature {} {name}, {}",
        if signed { "good for" } else { "NOT good for" },
        digits(&public)
    ))
}

fn images(arguments: &Arguments) -> Result<Vec<AlignedImage>, CliError> {
    if arguments.images.is_empty() {
        return Ok(BearingMaterial::ALL.map(|bearing| AlignedImage::copy(shipped(bearing))).to_vec());
    }
    let read = |path: &PathBuf| {
        AlignedImage::read(path).map_err(|source| CliError::Read { path: path.clone(), source }).and_then(
            |image| {
                let refused = inference::Model::<i16>::load(&image).err();
                match refused {
                    Some(source) => Err(CliError::Image { path: path.clone(), source }),
                    None => Ok(image),
                }
            },
        )
    };
    arguments.images.iter().map(read).collect()
}
