//! `model-quant verify`: image against float networks against laws.

use super::{CliError, bearings, checkpoint, parse_bearing, print_json};
use inference::{Bearing, Model, shipped as shipped_image};
use model_quant::verify::{Verdict, verify};
use std::path::{Path, PathBuf};

/// Compare model images with their float networks and with the laws, on rows that no training saw
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  model-quant verify\n  model-quant verify --image new/babbitt.pintle --checkpoint new/babbitt.float --json"
)]
pub(crate) struct Arguments {
    /// Bearing: babbitt or plastic; both if not given
    #[arg(long, value_parser = parse_bearing, conflicts_with = "image")]
    bearing: Option<Bearing>,
    /// Model image; the checked-in ones if not given
    #[arg(long, value_name = "FILE")]
    image: Option<PathBuf>,
    /// Float checkpoint the image was made from; the checked-in one of its bearing if not given
    #[arg(long, value_name = "FILE", requires = "image")]
    checkpoint: Option<PathBuf>,
    /// Print the figures as JSON
    #[arg(long)]
    json: bool,
    /// Write the figures as JSON to a file, too
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let mut verdicts = Vec::new();
    if let Some(path) = &arguments.image {
        let image = std::fs::read(path).map_err(|source| CliError::Read { path: path.clone(), source })?;
        let refused = |source| CliError::Image { path: path.clone(), source };
        let bearing = Model::load(&image).map_err(refused)?.header().bearing;
        verdicts.extend(check(arguments.checkpoint.as_deref(), bearing, &image, path)?);
    } else {
        for bearing in bearings(arguments.bearing) {
            let name = PathBuf::from(format!("shipped image of {}", bearing.name()));
            verdicts.extend(check(None, bearing, shipped_image(bearing), &name)?);
        }
    }
    if let Some(path) = &arguments.out {
        model_quant::write::write_whole(path, serde_json::to_string_pretty(&verdicts)?.as_bytes())?;
    }
    if arguments.json {
        return print_json(&verdicts);
    }
    super::print(format_args!(
        "bearing  network    R^2 float  R^2 image  mae N  median %    95 %  no contact N  CRC"
    ))?;
    for verdict in &verdicts {
        super::print(format_args!(
            "{:8} {:9}  {:9.6}  {:9.6}  {:5.1}  {:8.2}  {:6.2}  {:12}  {}",
            verdict.bearing,
            verdict.network,
            verdict.r2_float,
            verdict.r2_quantised,
            verdict.mae_n,
            100.0 * verdict.working_error_median,
            100.0 * verdict.working_error_p95,
            verdict.zero_contact_output,
            if verdict.image_crc_ok { "ok" } else { "wrong" }
        ))?;
    }
    super::print(format_args!("(relative errors at 1 to 14 kN and rate ratios up to 2)"))?;
    Ok(())
}

fn check(file: Option<&Path>, bearing: Bearing, image: &[u8], name: &Path) -> Result<[Verdict; 2], CliError> {
    let (checkpoint, training_id) = checkpoint(file, bearing)?;
    if checkpoint.bearing != bearing {
        let found = format!("a checkpoint of {}", checkpoint.bearing.name());
        return Err(CliError::Argument("--checkpoint", found, "one of the image's bearing"));
    }
    let refused = |source| CliError::Image { path: name.to_path_buf(), source };
    verify(&checkpoint, training_id, image).map_err(refused)
}
