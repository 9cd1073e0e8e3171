//! A network as a piece of Rust: its type, its bytes, its scales and a test of itself, for a crate without `std`.
//!
//! The file stands beside `NAME.layers` and needs nothing but the crate `inference`. That no sum overflows is proven when it is
//! compiled; the test of itself runs windows of the samples and compares the sums that were found here, bit for bit.

use super::quantised::Alone;
use super::samples::Samples;
use crate::network::{Padding, Shape};
use inference::image::{LayerKind, LayerShape, check_sum};
use std::fmt::{Result, Write};

/// Windows of the samples that the test of itself runs.
const CHECKED: usize = 4;

/// Words that no module can be called (Rust reference, keywords of the editions up to 2024).
const KEYWORDS: [&str; 51] = [
    "abstract", "as", "async", "await", "become", "box", "break", "const", "continue", "crate", "do", "dyn",
    "else", "enum", "extern", "false", "final", "fn", "for", "gen", "if", "impl", "in", "let", "loop",
    "macro", "match", "mod", "move", "mut", "override", "priv", "pub", "ref", "return", "self", "static",
    "struct", "super", "trait", "true", "try", "type", "typeof", "unsafe", "unsized", "use", "virtual",
    "where", "while", "yield",
];

/// Whether a file of this name can be a module.
pub fn is_module_name(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_lowercase())
        && name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
        && !KEYWORDS.contains(&name)
}

/// What a source file is made from.
#[derive(Clone, Copy, Debug)]
pub struct Facts<'a> {
    /// Name of the files.
    pub name: &'a str,
    /// The ONNX file and who wrote it.
    pub origin: &'a str,
    /// Shape of the network.
    pub shape: &'a Shape,
    /// The network in whole numbers.
    pub alone: &'a Alone,
    /// Its samples.
    pub samples: &'a Samples,
}

/// Writes the source file.
pub fn source(facts: &Facts<'_>) -> String {
    let mut text = String::new();
    // Writing to a string does not fail.
    let _ = write_source(&mut text, facts);
    text
}

/// Type of one layer.
fn layer(shape: &LayerShape) -> String {
    let LayerShape { columns, inputs, outputs, input_bits, output_bits, .. } = shape;
    match shape.kind {
        LayerKind::Convolution => {
            format!("Convolution<'a, i{input_bits}, i{output_bits}, {inputs}, {outputs}, {columns}>")
        }
        LayerKind::Head => format!("Head<'a, i{input_bits}, {inputs}, {columns}, {outputs}>"),
    }
}

/// Type of the whole network.
fn network(shapes: &[LayerShape]) -> String {
    match shapes {
        [head] => layer(head),
        [first, rest @ ..] => format!("Then<{}, {}>", layer(first), network(rest)),
        [] => String::new(),
    }
}

fn write_source(out: &mut String, facts: &Facts<'_>) -> Result {
    let Facts { name, origin, shape, alone, samples } = *facts;
    let Shape { columns, inputs, outputs, padding, .. } = shape;
    let (kind, how) = match padding {
        Padding::Valid => ("Valid", "`Streaming` takes one column after another and gives the same sums"),
        Padding::Same => ("Same", "`Windowed::slide` takes one column after another"),
    };
    writeln!(out, "//! Network `{name}`: {columns} columns of {inputs} values to {outputs} values.")?;
    writeln!(
        out,
        "//!\n//! Written by `model-quant import` from {origin}; do not edit. Needs the crate `inference` and"
    )?;
    writeln!(out, "//! `{name}.layers` beside it; no heap, no `std`. The model card is `{name}.md`.\n//!")?;
    writeln!(out, "//! ```text\n//! let network = {name}::load()?;")?;
    writeln!(out, "//! let mut window = {name}::Window::new(network);")?;
    writeln!(
        out,
        "//! let (Sums(sums), clipped) = window.evaluate(&columns.map(|column| {name}::counts(&column)));"
    )?;
    writeln!(out, "//! let values = {name}::values(&sums);\n//! ```\n//!\n//! {how}.\n")?;
    let has_convolutions = alone.shapes.len() > 1;
    let (chain, convolution) =
        if has_convolutions { ("{Sums, Then}", "Convolution, ") } else { ("Sums", "") };
    writeln!(out, "use inference::chain::{chain};")?;
    writeln!(out, "use inference::image::{{check_sum, load as load_layers, prove}};")?;
    writeln!(out, "use inference::{{{convolution}Head, ImageError, {kind}, Windowed}};\n")?;
    writeln!(out, "/// Columns of a window, oldest first.\npub const COLUMNS: usize = {columns};")?;
    writeln!(out, "/// Values of a column.\npub const INPUTS: usize = {inputs};")?;
    writeln!(out, "/// Values that the network gives.\npub const OUTPUTS: usize = {outputs};\n")?;
    writeln!(
        out,
        "/// The network's type.\n#[rustfmt::skip]\npub type Network<'a> = {};",
        network(&alone.shapes)
    )?;
    writeln!(out, "/// The network over a window.")?;
    writeln!(out, "pub type Window<'a> = Windowed<'a, Network<'a>, i16, INPUTS, COLUMNS, {kind}>;\n")?;
    writeln!(
        out,
        "/// Full scale of every value of a column, in the unit of the network's inputs: 32767 counts."
    )?;
    let list =
        |values: &[f32]| values.iter().map(|value| format!("{value:?}")).collect::<Vec<_>>().join(", ");
    writeln!(
        out,
        "#[rustfmt::skip]\npub const FULL_SCALE: [f32; INPUTS] = [{}];",
        list(alone.scale.full_scales())
    )?;
    writeln!(out, "#[rustfmt::skip]\nconst FACTORS: [f32; INPUTS] = [{}];", list(&alone.scale.factors()))?;
    writeln!(out, "/// What one count of a sum is worth, in the unit of the network's outputs.")?;
    writeln!(out, "pub const OUTPUT_STEP: f32 = {:?};", alone.interpreter.scale() as f32)?;
    writeln!(
        out,
        "/// CRC-32 of the layers.\npub const CHECK_SUM: u32 = {:#010x};\n",
        check_sum(&alone.bytes)
    )?;
    writeln!(out, "const BYTES: &[u8; {}] = include_bytes!(\"{name}.layers\");", alone.bytes.len())?;
    writeln!(
        out,
        "#[repr(C, align(4))]\nstruct Aligned([u8; BYTES.len()]);\nstatic LAYERS: Aligned = Aligned(*BYTES);"
    )?;
    writeln!(out, "/// No sum can overflow.\nconst _: () = assert!(prove(BYTES).is_ok());\n")?;
    out.write_str(FUNCTIONS.replace("NAME", name).as_str())?;
    write_checks(out, alone, samples)
}

/// What every network has.
const FUNCTIONS: &str = r#"/// The network, checked against its type and its check sum.
pub fn load() -> Result<Network<'static>, ImageError> {
    let found = check_sum(&LAYERS.0);
    if found != CHECK_SUM {
        return Err(ImageError::Crc { found, expected: CHECK_SUM });
    }
    load_layers(&LAYERS.0, "NAME")
}

/// A column in counts: rounded to nearest, clipped to 16 bits.
pub fn counts(column: &[f32; INPUTS]) -> [i16; INPUTS] {
    let mut counts = [0; INPUTS];
    for ((count, value), factor) in counts.iter_mut().zip(column).zip(FACTORS) {
        let scaled = value * factor;
        // A cast drops the fraction and clips.
        *count = if scaled < 0.0 { scaled - 0.5 } else { scaled + 0.5 } as i16;
    }
    counts
}

/// Sums in the unit of the network's outputs.
pub fn values(sums: &[i32; OUTPUTS]) -> [f32; OUTPUTS] {
    sums.map(|sum| sum as f32 * OUTPUT_STEP)
}

/// Whether the network gives the sums that it should, for windows of its samples.
pub fn self_test(network: Network<'static>) -> bool {
    let mut window = Window::new(network);
    CHECKS.iter().all(|(columns, sums)| window.evaluate(columns).0 == Sums(*sums))
}

"#;

fn write_checks(out: &mut String, alone: &Alone, samples: &Samples) -> Result {
    let windows: Vec<Vec<i16>> =
        samples.windows.iter().take(CHECKED).map(|window| alone.scale.counts(window).0).collect();
    writeln!(out, "/// Windows of the samples in counts, and their sums.\n#[rustfmt::skip]")?;
    writeln!(out, "static CHECKS: [([[i16; INPUTS]; COLUMNS], [i32; OUTPUTS]); {}] = [", windows.len())?;
    for window in &windows {
        let columns: Vec<String> =
            window.chunks(alone.scale.full_scales().len()).map(|column| format!("{column:?}")).collect();
        writeln!(out, "    (\n        [{}],", columns.join(", "))?;
        writeln!(out, "        {:?},\n    ),", alone.interpreter.run(window).sums)?;
    }
    writeln!(out, "];")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_module_s_name_is_lower_case_and_no_word_of_the_language() {
        for name in ["network", "conv_3", "selfish", "types"] {
            assert!(is_module_name(name), "{name}");
        }
        for name in ["", "3d", "_x", "Network", "a-b", "a b", "é", "match", "type", "self", "gen", "yield"] {
            assert!(!is_module_name(name), "{name}");
        }
        assert!(KEYWORDS.is_sorted());
    }
}
