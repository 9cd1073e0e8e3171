//! `model-quant export`: trained networks as ONNX and safetensors.

use crate::cli::checkpoint::{BearingParser, bearings, checkpoint};
use crate::cli::error::CliError;
use crate::cli::output::{print, print_json};
use crate::data::file_io::write_atomically;
use crate::exchange::description::{describe_network, describe_origin};
use crate::exchange::layout::Layout;
use crate::exchange::onnx_export;
use crate::exchange::reference_samples::generate_samples;
use crate::exchange::safetensors_export::to_bytes;
use crate::network::NetworkKind;
use inference::BearingMaterial;
use serde_json::json;
use std::path::PathBuf;

/// Export the float networks as ONNX and safetensors
///
/// Writes for every bearing BEARING-collision.onnx and BEARING-friction.onnx (input `columns`:
/// batch x values x columns, output `outputs`); BEARING.safetensors with all weights in the order
/// of PyTorch, before and after the training on the 8-bit grid; and samples of the test set,
/// BEARING-NETWORK-samples.safetensors, as reference for another runtime. The metadata name the
/// training, its ranges and the values of a column. `model-quant import` reads the ONNX files bit
/// for bit.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  model-quant export --bearing babbitt --out exported\n  \
                  model-quant export --checkpoint models/plastic.float --out exported --json\n  \
                  model-quant import exported/babbitt-friction.onnx \
                  --samples exported/babbitt-friction-samples.safetensors")]
pub(crate) struct Arguments {
    /// Bearing material; all if not given
    #[arg(long, value_parser = BearingParser, conflicts_with = "checkpoint")]
    bearing: Option<BearingMaterial>,
    /// Float checkpoint; the shipped ones if not given
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,
    /// Output directory
    #[arg(long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
    /// Print the files as JSON
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), CliError> {
    // A checkpoint file contains the name of its bearing.
    let chosen = if arguments.checkpoint.is_some() {
        vec![BearingMaterial::Babbitt]
    } else {
        bearings(arguments.bearing)
    };
    let mut summaries = Vec::new();
    for bearing in chosen {
        let (checkpoint, training_id) = checkpoint(arguments.checkpoint.as_deref(), bearing)?;
        let bearing = checkpoint.bearing.name();
        let mut files = Vec::new();
        let mut write = |name: String, bytes: &[u8]| {
            let path = arguments.out.join(name);
            files.push(path.display().to_string());
            write_atomically(&path, bytes)
        };
        for which in NetworkKind::ALL {
            let network = &checkpoint.trained(which).float;
            let metadata = [
                ("origin", describe_origin(&checkpoint, training_id).to_string()),
                ("description", describe_network(&checkpoint, which).to_string()),
            ];
            let name = format!("{bearing}-{}", which.name());
            write(format!("{name}.onnx"), &onnx_export::to_bytes(network, &name, &metadata))?;
            let samples =
                generate_samples(&checkpoint, which).to_bytes(network.shape(), Layout::ChannelsFirst)?;
            write(format!("{name}-samples.safetensors"), &samples)?;
        }
        write(format!("{bearing}.safetensors"), &to_bytes(&checkpoint, training_id)?)?;
        if !arguments.json {
            print(format_args!("{bearing}, training id {training_id:016x}: wrote {}", files.join(", ")))?;
        }
        summaries.push(json!({
            "bearing": bearing,
            "training_id": format!("{training_id:016x}"),
            "files": files,
        }));
    }
    if arguments.json { print_json(&summaries) } else { Ok(()) }
}
