//! Arguments of `model-quant import`.

use crate::cli::checkpoint::BearingParser;
use crate::quantise::mode::{Mode, Packing};
use inference::BearingMaterial;
use std::path::PathBuf;

/// Import a network from ONNX: check it, quantise it, write it as Rust source
///
/// Accepts the output of PyTorch (torch.onnx) and Keras (tf2onnx) for a chain of 1-D convolutions
/// (stride 1, all 'valid' or all 'same') with ReLU, flattening in either order and dense layers.
/// Anything else is refused with the name of the node: exit 2.
///
/// --samples is a safetensors file with two f32 tensors: `inputs`, samples x the axes of the ONNX
/// file's input, and `outputs`, samples x outputs of the framework. The network must agree with
/// them (--tolerance, else exit 1). They also calibrate the scales between the layers; the full
/// scale of every input is their largest value plus a sixteenth. A few hundred samples that cover
/// the range of use are enough. In Python:
///
///   safetensors.numpy.save_file({"inputs": x, "outputs": y}, "samples.safetensors")
///
/// Writes NAME.layers (bytes for the engine), NAME.rs (type, scales and self-test, for a `no_std`
/// crate that depends on `inference`) and NAME.md (model card). Without --samples the command only
/// prints a description of the network.
///
/// --bearing replaces the network of the same shape in that bearing's float checkpoint and writes
/// BEARING.float for `model-quant quantize`. The network must have the inputs and the output of
/// the shipped one (`model-quant export` lists them in the metadata). The recipe in that file
/// remains that of the checkpoint: it describes the ranges and the other network, not the training
/// of the imported one.
#[derive(Debug, clap::Args)]
#[command(
    verbatim_doc_comment,
    after_help = "Examples:\n  model-quant import model.onnx\n  \
                  model-quant import model.onnx --samples samples.safetensors --out src/network\n  \
                  model-quant import model.onnx --samples samples.safetensors --full-scale 1.5,0.02 \
                  --mode w16a16 --json\n  \
                  model-quant import friction.onnx --samples samples.safetensors --bearing babbitt \
                  --out models"
)]
pub(crate) struct Arguments {
    /// ONNX file
    #[arg(value_name = "FILE")]
    pub(super) file: PathBuf,
    /// Inputs and outputs of the framework as safetensors
    #[arg(long, value_name = "FILE")]
    pub(super) samples: Option<PathBuf>,
    /// Output directory
    #[arg(long, value_name = "DIR", default_value = ".")]
    pub(super) out: PathBuf,
    /// Name of the files; default: that of the ONNX file
    #[arg(long)]
    pub(super) name: Option<String>,
    /// Largest allowed difference from the samples, relative to their largest output
    #[arg(long, value_name = "X", default_value_t = 1e-5)]
    pub(super) tolerance: f64,
    /// Full scale of every value of a column; default: from the samples
    #[arg(long, value_name = "X,X,...", value_delimiter = ',', requires = "samples")]
    pub(super) full_scale: Option<Vec<f32>>,
    /// Widths of weights and activations
    #[arg(long, value_enum, default_value_t)]
    pub(super) mode: Mode,
    /// Storage of 8-bit weights for 16-bit activations
    #[arg(long, value_enum, default_value_t)]
    pub(super) packing: Packing,
    /// Replace a network of this bearing's float checkpoint instead
    #[arg(long, value_parser = BearingParser, conflicts_with_all = ["full_scale", "mode", "packing", "name"])]
    pub(super) bearing: Option<BearingMaterial>,
    /// Float checkpoint; the shipped one if not given
    #[arg(long, value_name = "FILE", requires = "bearing")]
    pub(super) checkpoint: Option<PathBuf>,
    /// Print the result as JSON
    #[arg(long)]
    pub(super) json: bool,
}
