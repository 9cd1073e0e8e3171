//! `model-quant quantize`: a model image and its card from a float checkpoint.

use super::{CliError, bearings, checkpoint, parse_bearing, print_json};
use inference::{Bearing, Model, shipped as shipped_image};
use model_quant::card::card;
use model_quant::quantise::{QuantiseError, quantise};
use model_quant::verify::verify;
use model_quant::write::write_whole;
use serde_json::json;
use std::path::PathBuf;

/// Quantise float checkpoints to model images and write their model cards
///
/// Weights to 8 bits per output channel, activations to 16 bits by the smallest and largest values of a seeded
/// calibration set. Without options this gives the checked-in images byte for byte; `--check` compares them.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  model-quant quantize --checkpoint model-quant/models/babbitt.float --out crates/inference/models\n  \
                        model-quant quantize --check"
)]
pub(crate) struct Arguments {
    /// Bearing: babbitt or plastic; both if not given
    #[arg(long, value_parser = parse_bearing, conflicts_with = "checkpoint")]
    bearing: Option<Bearing>,
    /// Float checkpoint; the checked-in ones if not given
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,
    /// Directory that gets BEARING.pintle and BEARING.md
    #[arg(long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
    /// Compare with the checked-in images, write nothing
    #[arg(long, conflicts_with_all = ["checkpoint", "out"])]
    check: bool,
    /// Print a summary as JSON
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let chosen =
        if arguments.checkpoint.is_some() { vec![Bearing::Babbitt] } else { bearings(arguments.bearing) };
    let mut summaries = Vec::new();
    let mut different = Vec::new();
    for bearing in chosen {
        let (checkpoint, training_id) = checkpoint(arguments.checkpoint.as_deref(), bearing)?;
        let name = checkpoint.bearing.name();
        let image = quantise(&checkpoint, training_id)?;
        let header = Model::load(image.as_slice()).map_err(QuantiseError::from)?.header();
        let equals_checked_in = image.as_slice() == shipped_image(checkpoint.bearing);
        if !equals_checked_in {
            different.push(name);
        }
        let file = arguments.out.join(format!("{name}.pintle"));
        if !arguments.check {
            let verdicts = verify(&checkpoint, training_id, image.as_slice()).map_err(QuantiseError::from)?;
            write_whole(
                &arguments.out.join(format!("{name}.md")),
                card(&checkpoint, &header, &verdicts).as_bytes(),
            )?;
            write_whole(&file, image.as_slice())?;
        }
        if !arguments.json {
            let did = if arguments.check { "quantised" } else { "wrote" };
            let equal = if equals_checked_in { "equal to" } else { "different from" };
            super::print(format_args!(
                "{did} {name}: {} bytes, CRC-32 {:08x}, {equal} the checked-in image",
                image.len(),
                header.crc
            ))?;
        }
        summaries.push(json!({
            "bearing": name,
            "file": (!arguments.check).then(|| file.display().to_string()),
            "bytes": image.len(),
            "crc": format!("{:08x}", header.crc),
            "training_id": format!("{training_id:016x}"),
            "equals_checked_in": equals_checked_in,
        }));
    }
    if arguments.json {
        print_json(&summaries)?;
    }
    if arguments.check && !different.is_empty() {
        return Err(CliError::Differs(format!(
            "checked-in image of {}: quantising its checkpoint again gave other bytes",
            different.join(" and ")
        )));
    }
    Ok(())
}
