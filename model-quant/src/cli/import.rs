//! `model-quant import`: a network from an ONNX file, checked, put into whole numbers and written as Rust.

mod replace;

use super::{CliError, parse_bearing, print, print_json};
use inference::Bearing;
use model_quant::exchange::card::{Facts as CardFacts, card};
use model_quant::exchange::error::OnnxError;
use model_quant::exchange::quantised::{Cost, quantise};
use model_quant::exchange::recognise::{Imported, import, one_line};
use model_quant::exchange::samples::{Difference, Samples, SamplesError};
use model_quant::exchange::scaling::InputScale;
use model_quant::exchange::source::{Facts as SourceFacts, is_module_name, source};
use model_quant::mode::{Mode, Packing, Plan};
use model_quant::write::write_whole;
use serde_json::json;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Largest ONNX or safetensors file that is read, in bytes.
const LARGEST_FILE: u64 = 64 << 20;

/// Import a network from ONNX: check it, put it into whole numbers, write it as Rust
///
/// Takes what PyTorch (torch.onnx) and Keras (tf2onnx) write for a chain of 1-D convolutions (stride 1, all 'valid' or all 'same') with
/// ReLU, flattening in either order and dense layers. Anything else is refused with the node's name: exit 2.
///
/// --samples is a safetensors file with two f32 tensors: `inputs`, samples x the axes of the ONNX file's input, and `outputs`,
/// samples x outputs, as the framework computed them. The network must agree with them (--tolerance, else exit 1); they
/// calibrate the scales between the layers, and the full scale of every input is their largest value plus a sixteenth. A few
/// hundred samples that cover the range of use are enough. In Python:
///
///   safetensors.numpy.save_file({"inputs": x, "outputs": y}, "samples.safetensors")
///
/// Writes NAME.layers (what the engine loads), NAME.rs (type, scales and a test of itself, for a crate without std that depends on
/// `inference`) and NAME.md (the model card). Without --samples only says what was found.
///
/// --bearing puts the network in place of the one of its shape in that bearing's float checkpoint and writes BEARING.float
/// for `model-quant quantize`. Its inputs must be the features of the shipped networks (`model-quant export` lists them in the
/// file's metadata), its output theirs. The recipe in that file stays the one of the checkpoint: it tells of the ranges and of the
/// other network, not of the training of the imported one.
#[derive(Debug, clap::Args)]
#[command(
    verbatim_doc_comment,
    after_help = "Examples:\n  model-quant import model.onnx\n  \
                  model-quant import model.onnx --samples samples.safetensors --out src/network\n  \
                  model-quant import model.onnx --samples samples.safetensors --full-scale 1.5,0.02 --mode w16a16 --json\n  \
                  model-quant import friction.onnx --samples samples.safetensors --bearing babbitt --out models"
)]
pub(crate) struct Arguments {
    /// ONNX file
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Inputs and outputs of the framework, as safetensors
    #[arg(long, value_name = "FILE")]
    samples: Option<PathBuf>,
    /// Directory that gets the files
    #[arg(long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
    /// Name of the files; that of the ONNX file if not given
    #[arg(long)]
    name: Option<String>,
    /// Largest difference from the samples, over their largest output
    #[arg(long, value_name = "X", default_value_t = 1e-5)]
    tolerance: f64,
    /// Full scale of every value of a column; from the samples if not given
    #[arg(long, value_name = "X,X,...", value_delimiter = ',', requires = "samples")]
    full_scale: Option<Vec<f32>>,
    /// Widths of weights and activations
    #[arg(long, value_enum, default_value_t)]
    mode: Mode,
    /// Storage of 8-bit weights for 16-bit activations
    #[arg(long, value_enum, default_value_t)]
    packing: Packing,
    /// Replace a network of this bearing's float checkpoint instead: babbitt or plastic
    #[arg(long, value_parser = parse_bearing, conflicts_with_all = ["full_scale", "mode", "packing", "name"])]
    bearing: Option<Bearing>,
    /// The float checkpoint; the checked-in one if not given
    #[arg(long, value_name = "FILE", requires = "bearing")]
    checkpoint: Option<PathBuf>,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// A file that was refused.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ImportError {
    #[error("{}: {source}", path.display())]
    Onnx { path: PathBuf, source: Box<OnnxError> },
    #[error("{}: {source}", path.display())]
    Samples { path: PathBuf, source: SamplesError },
    #[error("{}: found more bytes, expected at most {LARGEST_FILE}", .0.display())]
    Length(PathBuf),
}

fn read(path: &Path) -> Result<Vec<u8>, CliError> {
    let mut bytes = Vec::new();
    // One byte more tells that there are too many, of a file that has no end, too.
    let read = File::open(path).and_then(|file| file.take(LARGEST_FILE + 1).read_to_end(&mut bytes));
    match read {
        Err(source) => Err(CliError::Read { path: path.to_owned(), source }),
        Ok(_) if bytes.len() as u64 > LARGEST_FILE => Err(ImportError::Length(path.to_owned()).into()),
        Ok(_) => Ok(bytes),
    }
}

/// The name of the files: a Rust module's name.
fn name(arguments: &Arguments) -> Result<String, CliError> {
    let stem = arguments
        .file
        .file_stem()
        .map(|stem| stem.to_string_lossy().to_lowercase().replace(['-', ' ', '.'], "_"));
    let name = arguments.name.clone().or(stem).unwrap_or_default();
    let expected = "a to z, digits and _, a letter first, no word of Rust's own";
    if is_module_name(&name) { Ok(name) } else { Err(CliError::Argument("--name", name, expected)) }
}

/// The samples, and how far the network is off; refused when that is too far.
fn checked(arguments: &Arguments, imported: &Imported) -> Result<Option<(Samples, Difference)>, CliError> {
    let Some(path) = &arguments.samples else { return Ok(None) };
    let samples = Samples::read(&read(path)?, imported.network.shape(), imported.layout)
        .map_err(|source| ImportError::Samples { path: path.clone(), source })?;
    let difference = samples.difference(&imported.network);
    let found = difference.relative();
    if found <= arguments.tolerance {
        return Ok(Some((samples, difference)));
    }
    Err(CliError::Refused(format!(
        "{}: sample {}, output {}: the network is {:.3e} off the framework's output, {found:.2e} of the largest output; expected at \
         most {:e} (--tolerance); nothing written",
        path.display(),
        difference.sample,
        difference.output,
        difference.largest,
        arguments.tolerance
    )))
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let plan = Plan { mode: arguments.mode, packing: arguments.packing };
    if plan.mode == Mode::W16a16 && plan.packing == Packing::Flash {
        let expected = "speed: weights of more than 8 bits have one form of storage";
        return Err(CliError::Argument("--packing", "flash with --mode w16a16".to_owned(), expected));
    }
    if !(arguments.tolerance >= 0.0 && arguments.tolerance.is_finite()) {
        let found = arguments.tolerance.to_string();
        return Err(CliError::Argument("--tolerance", found, "a number, 0 or above"));
    }
    let imported = import(&read(&arguments.file)?)
        .map_err(|source| ImportError::Onnx { path: arguments.file.clone(), source: Box::new(source) })?;
    let checked = checked(arguments, &imported)?;
    if let Some(bearing) = arguments.bearing {
        return replace::replace(arguments, bearing, &imported, checked.as_ref());
    }
    let Some((samples, difference)) = checked else { return summarise(arguments, &imported, None) };
    let inputs = imported.network.shape().inputs;
    let scale = match &arguments.full_scale {
        None => InputScale::of(&samples, inputs),
        Some(given) => InputScale::given(given, inputs).ok_or_else(|| {
            let found = format!("{given:?} for {inputs} values of a column");
            CliError::Argument("--full-scale", found, "one number above 0 for each value of a column")
        })?,
    };
    let name = name(arguments)?;
    let alone = quantise(&imported.network, scale, &samples, plan).map_err(|error| {
        let hint =
            if plan.mode.has_narrow_weights() { "; --mode w16a16 has room for finer weights" } else { "" };
        CliError::Refused(format!("{}: {error}{hint}; nothing written", arguments.file.display()))
    })?;
    let cost = alone.cost(&imported.network, &samples);
    let file = arguments.file.file_name().map_or_else(String::new, |file| one_line(&file.to_string_lossy()));
    let text = card(&CardFacts {
        name: &name,
        file: &file,
        imported: &imported,
        samples: &samples,
        difference,
        tolerance: arguments.tolerance,
        plan,
        alone: &alone,
        cost: &cost,
    });
    let origin = format!("`{file}` ({})", imported.producer);
    let shape = imported.network.shape();
    let rust = source(&SourceFacts { name: &name, origin: &origin, shape, alone: &alone, samples: &samples });
    let path = |extension: &str| arguments.out.join(format!("{name}.{extension}"));
    write_whole(&path("layers"), &alone.bytes)?;
    write_whole(&path("rs"), rust.as_bytes())?;
    write_whole(&path("md"), text.as_bytes())?;
    let done = Done {
        files: ["layers", "rs", "md"].map(path),
        bytes: alone.bytes.len(),
        full_scales: alone.scale.full_scales(),
        difference,
        cost: &cost,
    };
    summarise(arguments, &imported, Some(&done))
}

/// What was written and how good it is.
struct Done<'a> {
    files: [PathBuf; 3],
    bytes: usize,
    full_scales: &'a [f32],
    difference: Difference,
    cost: &'a Cost,
}

fn summarise(arguments: &Arguments, imported: &Imported, done: Option<&Done<'_>>) -> Result<(), CliError> {
    let shape = imported.network.shape();
    if arguments.json {
        let mut summary = json!({
            "file": arguments.file.display().to_string(),
            "producer": imported.producer,
            "layout": imported.layout,
            "shape": shape,
            "parameters": shape.parameters(),
            "macs": shape.macs(),
        });
        if let (Some(done), Some(fields)) = (done, summary.as_object_mut()) {
            let further = json!({
                "mode": arguments.mode,
                "packing": arguments.packing,
                "files": done.files.each_ref().map(|file| file.display().to_string()),
                "bytes": done.bytes,
                "full_scale": done.full_scales,
                "difference": done.difference,
                "relative_difference": done.difference.relative(),
                "cost": done.cost,
            });
            fields.extend(further.as_object().cloned().unwrap_or_default());
        }
        return print_json(&summary);
    }
    print(format_args!(
        "{}: {} columns of {} values, {} convolutions, {} outputs, {} parameters",
        arguments.file.display(),
        shape.columns,
        shape.inputs,
        shape.convolutions.len(),
        shape.outputs,
        shape.parameters()
    ))?;
    let Some(done) = done else {
        return print(format_args!(
            "nothing written: quantising takes the framework's inputs and outputs (--samples)"
        ));
    };
    print(format_args!(
        "off the framework by at most {:.2e}, {:.1e} of the largest output",
        done.difference.largest,
        done.difference.relative()
    ))?;
    for (index, output) in done.cost.outputs.iter().enumerate() {
        print(format_args!(
            "output {index}: whole numbers are off by {:.3e} rms, {:.3e} at most ({:.3} % and {:.3} % of the range)",
            output.rms,
            output.largest,
            output.percent(output.rms),
            output.percent(output.largest)
        ))?;
    }
    let [layers, rust, card] = done.files.each_ref().map(|file| file.display().to_string());
    print(format_args!("wrote {layers} ({} bytes), {rust}, {card}", done.bytes))
}
