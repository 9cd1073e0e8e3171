//! `model-quant import`: checks and quantises a network from an ONNX file and writes it as Rust
//! source.

mod arguments;
mod replace;

pub(crate) use arguments::Arguments;

use crate::cli::error::{CliError, ImportError, MAX_FILE_BYTES};
use crate::cli::output::{print, print_json};
use crate::data::file_io::write_atomically;
use crate::exchange::card::{CardContents, card};
use crate::exchange::input_scale::InputScale;
use crate::exchange::onnx_import::{Imported, import, one_line};
use crate::exchange::quantised::{QuantisationError, quantise_imported};
use crate::exchange::rust_source::{SourceContents, is_module_name, source};
use crate::exchange::samples::{Difference, Samples};
use crate::quantise::mode::{Mode, Packing, Plan};
use serde_json::json;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

fn read(path: &Path) -> Result<Vec<u8>, CliError> {
    let mut bytes = Vec::new();
    // One byte more than the limit shows that the file is too long, even if it has no end.
    let read = File::open(path).and_then(|file| file.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes));
    match read {
        Err(source) => Err(CliError::Read { path: path.to_owned(), source }),
        Ok(_) if bytes.len() as u64 > MAX_FILE_BYTES => Err(ImportError::Length(path.to_owned()).into()),
        Ok(_) => Ok(bytes),
    }
}

/// Name of the files, which must be a valid Rust module name.
fn name(arguments: &Arguments) -> Result<String, CliError> {
    let stem = arguments
        .file
        .file_stem()
        .map(|stem| stem.to_string_lossy().to_lowercase().replace(['-', ' ', '.'], "_"));
    let name = arguments.name.clone().or(stem).unwrap_or_default();
    let expected = "a to z, digits and _, beginning with a letter, no Rust keyword";
    if is_module_name(&name) { Ok(name) } else { Err(CliError::Argument("--name", name, expected)) }
}

/// Reads the samples and compares the network with them; refuses a difference above the tolerance.
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
        "{}: sample {}, output {}: the network differs from the framework's output by {:.3e}, {found:.2e} \
         of the largest output; expected at most {:e} (--tolerance); nothing written",
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
        let expected = "speed: weights of more than 8 bits have only one form of storage";
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
        None => InputScale::from_samples(&samples, inputs),
        Some(given) => InputScale::given(given, inputs).ok_or_else(|| {
            let found = format!("{given:?} for {inputs} values of a column");
            CliError::Argument("--full-scale", found, "one number above 0 for each value of a column")
        })?,
    };
    let name = name(arguments)?;
    let quantised = quantise_imported(&imported.network, scale, &samples, plan).map_err(|error| {
        let hint =
            if plan.mode.has_narrow_weights() { "; --mode w16a16 has room for finer weights" } else { "" };
        CliError::Refused(format!("{}: {error}{hint}; nothing written", arguments.file.display()))
    })?;
    let error = quantised.measure_error(&imported.network, &samples);
    let file = arguments.file.file_name().map_or_else(String::new, |file| one_line(&file.to_string_lossy()));
    let text = card(&CardContents {
        name: &name,
        file: &file,
        imported: &imported,
        samples: &samples,
        difference,
        tolerance: arguments.tolerance,
        plan,
        quantised: &quantised,
        error: &error,
    });
    let origin = format!("`{file}` ({})", imported.producer);
    let shape = imported.network.shape();
    let rust = source(&SourceContents {
        name: &name,
        origin: &origin,
        shape,
        quantised: &quantised,
        samples: &samples,
    });
    let path = |extension: &str| arguments.out.join(format!("{name}.{extension}"));
    write_atomically(&path("layers"), &quantised.bytes)?;
    write_atomically(&path("rs"), rust.as_bytes())?;
    write_atomically(&path("md"), text.as_bytes())?;
    let written = Written {
        files: ["layers", "rs", "md"].map(path),
        bytes: quantised.bytes.len(),
        full_scales: quantised.scale.full_scales(),
        difference,
        error: &error,
    };
    summarise(arguments, &imported, Some(&written))
}

/// Written files and their errors.
struct Written<'a> {
    files: [PathBuf; 3],
    bytes: usize,
    full_scales: &'a [f32],
    difference: Difference,
    error: &'a QuantisationError,
}

fn summarise(
    arguments: &Arguments,
    imported: &Imported,
    written: Option<&Written<'_>>,
) -> Result<(), CliError> {
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
        if let (Some(written), Some(fields)) = (written, summary.as_object_mut()) {
            let further = json!({
                "mode": arguments.mode,
                "packing": arguments.packing,
                "files": written.files.each_ref().map(|file| file.display().to_string()),
                "bytes": written.bytes,
                "full_scale": written.full_scales,
                "difference": written.difference,
                "relative_difference": written.difference.relative(),
                "cost": written.error,
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
    let Some(written) = written else {
        return print(format_args!(
            "nothing written: quantisation requires inputs and outputs of the framework (--samples)"
        ));
    };
    print(format_args!(
        "difference from the framework at most {:.2e}, {:.1e} of the largest output",
        written.difference.largest,
        written.difference.relative()
    ))?;
    for (index, output) in written.error.outputs.iter().enumerate() {
        print(format_args!(
            "output {index}: quantisation error {:.3e} rms, {:.3e} at most \
             ({:.3} % and {:.3} % of the range)",
            output.rms,
            output.largest,
            output.percent(output.rms),
            output.percent(output.largest)
        ))?;
    }
    let [layers, rust, card] = written.files.each_ref().map(|file| file.display().to_string());
    print(format_args!("wrote {layers} ({} bytes), {rust}, {card}", written.bytes))
}
