//! `model-quant export`: what was trained, for other tools.

use super::{CliError, bearings, checkpoint, parse_bearing, print, print_json};
use inference::Bearing;
use model_quant::exchange::description::{Which, network as described, origin};
use model_quant::exchange::export::windows;
use model_quant::exchange::onnx;
use model_quant::exchange::recognise::Layout;
use model_quant::exchange::weights::{to_bytes, trained};
use model_quant::write::write_whole;
use serde_json::json;
use std::path::PathBuf;

/// Export the float networks as ONNX and safetensors
///
/// For every bearing: BEARING-collision.onnx and BEARING-friction.onnx (input `columns`: batch x values x columns, output `outputs`),
/// BEARING.safetensors (all weights in the order of PyTorch, as trained and after the training on the 8-bit grid), and for
/// each network samples of the test set, BEARING-NETWORK-samples.safetensors, with which another runtime can be checked.
/// Metadata name the training, its ranges and the values of a column. `model-quant import` reads the ONNX files back, bit for bit.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  model-quant export --bearing babbitt --out exported\n  \
                  model-quant export --checkpoint models/plastic.float --out exported --json\n  \
                  model-quant import exported/babbitt-friction.onnx --samples exported/babbitt-friction-samples.safetensors")]
pub(crate) struct Arguments {
    /// Bearing: babbitt or plastic; both if not given
    #[arg(long, value_parser = parse_bearing, conflicts_with = "checkpoint")]
    bearing: Option<Bearing>,
    /// Float checkpoint; the checked-in ones if not given
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,
    /// Directory that gets the files
    #[arg(long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
    /// Print the files as JSON
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), CliError> {
    // The checkpoint names its bearing itself.
    let chosen =
        if arguments.checkpoint.is_some() { vec![Bearing::Babbitt] } else { bearings(arguments.bearing) };
    let mut summaries = Vec::new();
    for bearing in chosen {
        let (checkpoint, training_id) = checkpoint(arguments.checkpoint.as_deref(), bearing)?;
        let bearing = checkpoint.bearing.name();
        let mut files = Vec::new();
        let mut write = |name: String, bytes: &[u8]| {
            let path = arguments.out.join(name);
            files.push(path.display().to_string());
            write_whole(&path, bytes)
        };
        for which in Which::ALL {
            let network = &trained(&checkpoint, which).float;
            let metadata = [
                ("origin", origin(&checkpoint, training_id).to_string()),
                ("description", described(&checkpoint, which).to_string()),
            ];
            let name = format!("{bearing}-{}", which.name());
            write(format!("{name}.onnx"), &onnx::to_bytes(network, &name, &metadata))?;
            let samples = windows(&checkpoint, which).to_bytes(network.shape(), Layout::ChannelsFirst)?;
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
