//! Model card of an imported network: origin, shape, and error of the quantisation.

use super::layout::Layout;
use super::onnx_import::Imported;
use super::quantised::{QuantisationError, QuantisedNetwork};
use super::samples::{Difference, Samples};
use crate::quantise::mode::Plan;
use inference::image::checksum;
use std::fmt::{Result, Write};

/// Content of a card.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CardContents<'a> {
    /// Name of the files.
    pub name: &'a str,
    /// The ONNX file.
    pub file: &'a str,
    /// Network read from it.
    pub imported: &'a Imported,
    /// Samples that it was checked with.
    pub samples: &'a Samples,
    /// Difference from the samples' outputs.
    pub difference: Difference,
    /// Largest allowed relative difference.
    pub tolerance: f64,
    /// Options of the quantisation.
    pub plan: Plan,
    /// Quantised network.
    pub quantised: &'a QuantisedNetwork,
    /// Quantisation error.
    pub error: &'a QuantisationError,
}

/// Writes the card as Markdown.
pub(crate) fn card(contents: &CardContents<'_>) -> String {
    let mut text = String::new();
    // Writing to a string does not fail.
    let _ = write_card(&mut text, contents);
    text
}

fn write_card(out: &mut String, contents: &CardContents<'_>) -> Result {
    write_network(out, contents)?;
    write_check(out, contents)?;
    write_inputs(out, contents)?;
    write_error(out, contents)?;
    write_limits(out)
}

/// Writes the title and the table of origin, shape and files.
fn write_network(out: &mut String, contents: &CardContents<'_>) -> Result {
    let CardContents { name, file, imported, plan, quantised, .. } = *contents;
    let shape = imported.network.shape();
    writeln!(
        out,
        "# Model card: {name}\n\nWritten by `model-quant import`; do not edit.\n\n| | |\n|---|---|"
    )?;
    let producer = if imported.producer.is_empty() { "unknown" } else { &imported.producer };
    writeln!(out, "| from | `{file}`, written by {producer} |")?;
    let order = match imported.layout {
        Layout::ColumnsFirst => "columns x values",
        Layout::ChannelsFirst => "values x columns",
    };
    writeln!(out, "| input | {} columns of {} values; in the file {order} |", shape.columns, shape.inputs)?;
    let padding = shape.padding.name();
    let convolutions: Vec<String> = shape
        .convolutions
        .iter()
        .map(|c| format!("{} channels over {} columns", c.outputs, c.kernel))
        .collect();
    writeln!(out, "| convolutions | {padding}, ReLU: {} |", convolutions.join("; "))?;
    writeln!(out, "| head | {} outputs, dense over all remaining columns |", shape.outputs)?;
    writeln!(out, "| parameters | {} |", shape.parameters())?;
    writeln!(out, "| multiply-accumulates | {} a window |", shape.macs())?;
    let crc = checksum(&quantised.bytes);
    writeln!(out, "| layers | `{name}.layers`, {} bytes, CRC-32 {crc:08x} |", quantised.bytes.len())?;
    writeln!(out, "| mode | {}, packed for {} |\n", plan.mode.name(), plan.packing.name())
}

/// Writes the difference from the framework's outputs.
fn write_check(out: &mut String, contents: &CardContents<'_>) -> Result {
    let CardContents { samples, difference, tolerance, .. } = *contents;
    writeln!(out, "## Check against the framework\n")?;
    writeln!(
        out,
        "{} samples; they also serve for the calibration and for every figure below. The \
         imported f32 network\n\
         differs from the framework's outputs by at most {:.3e} (sample {}, output {}): {:.2e} of their\n\
         largest magnitude {:.6}, allowed {tolerance:e}.\n",
        samples.windows.len(),
        difference.largest,
        difference.sample,
        difference.output,
        difference.relative(),
        difference.full_scale,
    )
}

/// Writes the full scale of every input and the number of clipped values.
fn write_inputs(out: &mut String, contents: &CardContents<'_>) -> Result {
    let CardContents { quantised, error, .. } = *contents;
    writeln!(out, "## Inputs\n")?;
    writeln!(
        out,
        "16 bits, 32767 counts at full scale; larger values are clipped.\n\n\
         | value of a column | full scale |\n|---|---|"
    )?;
    for (index, full_scale) in quantised.scale.full_scales().iter().enumerate() {
        writeln!(out, "| {index} | {full_scale} |")?;
    }
    writeln!(
        out,
        "\nIn the samples {} inputs and {} activations were clipped.\n",
        error.clipped_inputs, error.clipped_activations
    )
}

/// Writes the quantisation error of every output.
fn write_error(out: &mut String, contents: &CardContents<'_>) -> Result {
    let CardContents { quantised, error, .. } = *contents;
    writeln!(out, "## Quantisation error\n")?;
    writeln!(
        out,
        "Difference from the float network over the samples, in the unit of the output, and in % of its\n\
         range.\n"
    )?;
    writeln!(out, "| output | range | mean | rms | largest |\n|---|---|---|---|---|")?;
    for (index, output) in error.outputs.iter().enumerate() {
        let [low, high] = output.range;
        let with_share = |error: f64| format!("{error:.3e} ({:.3} %)", output.percent(error));
        let [mean, rms, largest] = [output.mean, output.rms, output.largest].map(with_share);
        writeln!(out, "| {index} | {low:.6} to {high:.6} | {mean} | {rms} | {largest} |")?;
    }
    writeln!(out, "\nValue of one count of a sum: {:e}.\n", quantised.interpreter.scale())
}

fn write_limits(out: &mut String) -> Result {
    writeln!(out, "## Limits\n")?;
    writeln!(
        out,
        "Weights are rounded after training, without further training on their grid; \
         `--mode w16a16` measures\n\
         the error of that. The figures hold for inputs like the samples; a network that was trained on\n\
         other ranges needs samples that cover them."
    )
}
