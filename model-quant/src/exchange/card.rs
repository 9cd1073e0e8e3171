//! The model card of an imported network: where it comes from, what it looks like, what the whole numbers cost.

use super::quantised::{Alone, Cost};
use super::recognise::{Imported, Layout};
use super::samples::{Difference, Samples};
use crate::mode::Plan;
use crate::network::Padding;
use inference::image::check_sum;
use std::fmt::{Result, Write};

/// What a card tells of.
#[derive(Clone, Copy, Debug)]
pub struct Facts<'a> {
    /// Name of the files.
    pub name: &'a str,
    /// The ONNX file.
    pub file: &'a str,
    /// What was read from it.
    pub imported: &'a Imported,
    /// What it was checked with.
    pub samples: &'a Samples,
    /// How far it was off.
    pub difference: Difference,
    /// Largest relative difference that was allowed.
    pub tolerance: f64,
    /// How it was put into whole numbers.
    pub plan: Plan,
    /// The result.
    pub alone: &'a Alone,
    /// What that costs.
    pub cost: &'a Cost,
}

/// Writes the card as Markdown.
pub fn card(facts: &Facts<'_>) -> String {
    let mut text = String::new();
    // Writing to a string does not fail.
    let _ = write_card(&mut text, facts);
    text
}

fn write_card(out: &mut String, facts: &Facts<'_>) -> Result {
    let Facts { name, file, imported, samples, difference, tolerance, plan, alone, cost } = *facts;
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
    let padding = match shape.padding {
        Padding::Valid => "valid",
        Padding::Same => "same",
    };
    let convolutions: Vec<String> = shape
        .convolutions
        .iter()
        .map(|c| format!("{} channels over {} columns", c.outputs, c.kernel))
        .collect();
    writeln!(out, "| convolutions | '{padding}', ReLU: {} |", convolutions.join("; "))?;
    writeln!(out, "| head | {} outputs, dense over all columns that are left |", shape.outputs)?;
    writeln!(out, "| parameters | {} |", shape.parameters())?;
    writeln!(out, "| multiply-accumulates | {} a window |", shape.macs())?;
    let crc = check_sum(&alone.bytes);
    writeln!(out, "| layers | `{name}.layers`, {} bytes, CRC-32 {crc:08x} |", alone.bytes.len())?;
    writeln!(out, "| mode | {}, packed for {} |\n", plan.mode.name(), plan.packing.name())?;

    writeln!(out, "## Check against the framework\n")?;
    writeln!(
        out,
        "{} samples, which are also those of the calibration and of every figure below. The network as it was read, in f32, is at most {:.3e}\n\
         (sample {}, output {}) off the framework's outputs: {:.2e} of their largest magnitude {:.6}, allowed {tolerance:e}.\n",
        samples.windows.len(),
        difference.largest,
        difference.sample,
        difference.output,
        difference.relative(),
        difference.full_scale,
    )?;

    writeln!(out, "## Inputs\n")?;
    writeln!(
        out,
        "16 bits, 32767 counts at full scale; what lies beyond is clipped.\n\n| value of a column | full scale |\n|---|---|"
    )?;
    for (index, full_scale) in alone.scale.full_scales().iter().enumerate() {
        writeln!(out, "| {index} | {full_scale} |")?;
    }
    writeln!(
        out,
        "\nIn the samples {} inputs and {} activations were clipped.\n",
        cost.clipped_inputs, cost.clipped_activations
    )?;

    writeln!(out, "## Cost of the whole numbers\n")?;
    writeln!(
        out,
        "Difference from the float network over the samples, in the unit of the output; in brackets % of the output's range.\n"
    )?;
    writeln!(out, "| output | range | mean | rms | largest |\n|---|---|---|---|---|")?;
    for (index, output) in cost.outputs.iter().enumerate() {
        let [low, high] = output.range;
        let with_share = |error: f64| format!("{error:.3e} ({:.3} %)", output.percent(error));
        let [mean, rms, largest] = [output.mean, output.rms, output.largest].map(with_share);
        writeln!(out, "| {index} | {low:.6} to {high:.6} | {mean} | {rms} | {largest} |")?;
    }
    writeln!(out, "\nOne count of a sum is worth {:e}.\n", alone.interpreter.scale())?;

    writeln!(out, "## Limits\n")?;
    writeln!(
        out,
        "Weights are rounded after training; nothing was trained on their grid. `--mode w16a16` shows what that costs. The figures\n\
         hold for inputs like the samples; a network that was trained on other ranges needs samples that cover them."
    )
}
