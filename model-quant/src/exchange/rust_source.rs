//! Rust source of an imported network: type, bytes, scales and self-test, for `no_std` crates.
//!
//! The file includes `NAME.layers` and depends on the crate `inference` only. Its compilation
//! proves that no sum overflows. The self-test runs windows of the samples and compares the sums
//! bit for bit.

use super::quantised::QuantisedNetwork;
use super::samples::Samples;
use crate::network::{Padding, Shape};
use inference::image::{LayerKind, LayerShape, checksum};
use std::fmt::{Result, Write};

/// Number of windows in the self-test.
const CHECKED: usize = 4;

/// Keywords, which cannot be module names (Rust reference, editions up to 2024).
const KEYWORDS: [&str; 51] = [
    "abstract", "as", "async", "await", "become", "box", "break", "const", "continue", "crate", "do", "dyn",
    "else", "enum", "extern", "false", "final", "fn", "for", "gen", "if", "impl", "in", "let", "loop",
    "macro", "match", "mod", "move", "mut", "override", "priv", "pub", "ref", "return", "self", "static",
    "struct", "super", "trait", "true", "try", "type", "typeof", "unsafe", "unsized", "use", "virtual",
    "where", "while", "yield",
];

/// Returns true if a file of this name can be a module.
pub(crate) fn is_module_name(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_lowercase())
        && name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
        && !KEYWORDS.contains(&name)
}

/// Content of a source file.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SourceContents<'a> {
    /// Name of the files.
    pub name: &'a str,
    /// ONNX file and the program that wrote it.
    pub origin: &'a str,
    /// Shape of the network.
    pub shape: &'a Shape,
    /// Fixed-point network.
    pub quantised: &'a QuantisedNetwork,
    /// Its samples.
    pub samples: &'a Samples,
}

/// Writes the source file.
pub(crate) fn source(contents: &SourceContents<'_>) -> String {
    let mut text = String::new();
    // Writing to a string does not fail.
    let _ = write_source(&mut text, contents);
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

/// Type of the network, one layer a line.
fn network(shapes: &[LayerShape]) -> String {
    match shapes {
        [head] => layer(head),
        [first, rest @ ..] => format!("Then<{},\n    {}>", layer(first), network(rest)),
        [] => String::new(),
    }
}

fn write_source(out: &mut String, contents: &SourceContents<'_>) -> Result {
    let SourceContents { name, origin, shape, quantised, samples } = *contents;
    let Shape { columns, inputs, outputs, padding, .. } = shape;
    let (kind, how) = match padding {
        Padding::Valid => ("Valid", "`Streaming` takes one column after another and gives the same sums"),
        Padding::Same => ("Same", "`Windowed::slide` takes one column after another"),
    };
    writeln!(out, "//! Network `{name}`: {columns} columns of {inputs} values to {outputs} values.")?;
    writeln!(out, "//!\n//! Written by `model-quant import` from {origin}; do not edit.\n//!")?;
    writeln!(out, "//! Needs the crate `inference` and the file `{name}.layers` in the same directory, but")?;
    writeln!(out, "//! neither heap nor `std`. The model card is `{name}.md`.\n//!")?;
    writeln!(out, "//! ```text\n//! let network = {name}::load()?;")?;
    writeln!(out, "//! let mut window = {name}::Window::new(network);")?;
    writeln!(out, "//! let counts = columns.map(|column| {name}::counts(&column));")?;
    writeln!(out, "//! let (Sums(sums), clipped) = window.evaluate(&counts);")?;
    writeln!(out, "//! let values = {name}::values(&sums);\n//! ```\n//!\n//! {how}.\n")?;
    let has_convolutions = quantised.shapes.len() > 1;
    let (chain, convolution) =
        if has_convolutions { ("{Sums, Then}", "Convolution, ") } else { ("Sums", "") };
    writeln!(out, "use inference::chain::{chain};")?;
    writeln!(out, "use inference::image::{{checksum, load_layers, prove}};")?;
    writeln!(out, "use inference::{{{convolution}Head, ImageError, {kind}, Windowed}};\n")?;
    writeln!(out, "/// Columns of a window, oldest first.\npub const COLUMNS: usize = {columns};")?;
    writeln!(out, "/// Values of a column.\npub const INPUTS: usize = {inputs};")?;
    writeln!(out, "/// Values that the network gives.\npub const OUTPUTS: usize = {outputs};\n")?;
    writeln!(
        out,
        "/// The network's type.\n#[rustfmt::skip]\npub type Network<'a> =\n    {};",
        network(&quantised.shapes)
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
        list(quantised.scale.full_scales())
    )?;
    writeln!(
        out,
        "#[rustfmt::skip]\nconst FACTORS: [f32; INPUTS] = [{}];",
        list(&quantised.scale.factors())
    )?;
    writeln!(out, "/// Value of one count of a sum, in the unit of the network's outputs.")?;
    writeln!(out, "pub const OUTPUT_STEP: f32 = {:?};", quantised.interpreter.scale() as f32)?;
    writeln!(
        out,
        "/// CRC-32 of the layers.\npub const CHECKSUM: u32 = {:#010x};\n",
        checksum(&quantised.bytes)
    )?;
    writeln!(out, "const BYTES: &[u8; {}] = include_bytes!(\"{name}.layers\");", quantised.bytes.len())?;
    writeln!(
        out,
        "#[repr(C, align(4))]\nstruct Aligned([u8; BYTES.len()]);\nstatic LAYERS: Aligned = Aligned(*BYTES);"
    )?;
    writeln!(out, "/// No sum can overflow.\nconst _: () = assert!(prove(BYTES).is_ok());\n")?;
    out.write_str(FUNCTIONS.replace("NAME", name).as_str())?;
    write_checks(out, quantised, samples)
}

/// Functions of every generated file.
const FUNCTIONS: &str = r#"/// Loads the network after checks of its type and its checksum.
pub fn load() -> Result<Network<'static>, ImageError> {
    let found = checksum(&LAYERS.0);
    if found != CHECKSUM {
        return Err(ImageError::Crc { found, expected: CHECKSUM });
    }
    load_layers(&LAYERS.0, "NAME")
}

/// Converts a column to counts: rounded to nearest, clipped to 16 bits.
pub fn counts(column: &[f32; INPUTS]) -> [i16; INPUTS] {
    let mut counts = [0; INPUTS];
    for ((count, value), factor) in counts.iter_mut().zip(column).zip(FACTORS) {
        let scaled = value * factor;
        // A cast truncates and saturates.
        *count = if scaled < 0.0 { scaled - 0.5 } else { scaled + 0.5 } as i16;
    }
    counts
}

/// Converts sums to the unit of the network's outputs.
pub fn values(sums: &[i32; OUTPUTS]) -> [f32; OUTPUTS] {
    sums.map(|sum| sum as f32 * OUTPUT_STEP)
}

/// Returns true if the network gives the expected sums for windows of its samples.
pub fn self_test(network: Network<'static>) -> bool {
    let mut window = Window::new(network);
    CHECKS.iter().all(|(columns, sums)| window.evaluate(columns).0 == Sums(*sums))
}

"#;

fn write_checks(out: &mut String, quantised: &QuantisedNetwork, samples: &Samples) -> Result {
    let windows: Vec<Vec<i16>> =
        samples.windows.iter().take(CHECKED).map(|window| quantised.scale.counts(window).0).collect();
    writeln!(out, "/// Windows of the samples in counts, and their sums.\n#[rustfmt::skip]")?;
    writeln!(out, "static CHECKS: [([[i16; INPUTS]; COLUMNS], [i32; OUTPUTS]); {}] = [", windows.len())?;
    for window in &windows {
        writeln!(out, "    (\n        [")?;
        for column in window.chunks(quantised.scale.full_scales().len()) {
            writeln!(out, "            {column:?},")?;
        }
        writeln!(out, "        ],\n        {:?},\n    ),", quantised.interpreter.run(window).sums)?;
    }
    writeln!(out, "];")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_module_name_is_lower_case_and_not_a_keyword() {
        for name in ["network", "conv_3", "selfish", "types"] {
            assert!(is_module_name(name), "{name}");
        }
        for name in ["", "3d", "_x", "Network", "a-b", "a b", "é", "match", "type", "self", "gen", "yield"] {
            assert!(!is_module_name(name), "{name}");
        }
        assert!(KEYWORDS.is_sorted());
    }
}
