//! Tables of instruction counts in Markdown, as the README shows them.

use crate::counts::Counts;
use inference::BearingMaterial;
use std::fmt::Write;

/// Rows of the reference network: name of the figure without the mode, and its description.
const MODES: [(&str, &str); 3] = [
    ("reference_window", "reference network, whole window of 32 columns, 'same' padding"),
    ("reference_reuse", "the same moved on by one column, exact reuse"),
    ("reference_stream", "causal stream, per new column"),
];

/// Shapes of the layers, with counts at one and two positions.
const CONVOLUTIONS: [&str; 6] =
    ["5x6_to_16", "5x16_to_32", "3x32_to_32", "3x4_to_16", "3x8_to_16", "3x16_to_16"];
const HEADS: [&str; 2] = ["32x32", "2x16"];

/// Returns both tables and the sizes.
pub(crate) fn render(counts: &Counts) -> String {
    let mut text = String::new();
    let figure = |name: &str| {
        counts.figures.get(name).map_or_else(
            || "-".to_owned(),
            |figure| {
                let most = figure.max.to_string();
                if figure.min == figure.max { most } else { format!("{}-{most}", figure.min) }
            },
        )
    };
    let ratio = |name: &str| {
        counts.figures.get(name).map_or_else(
            || "-".to_owned(),
            |figure| format!("{:.2}", figure.max as f64 / figure.macs.max(1) as f64),
        )
    };
    // Writing to a string does not fail.
    let mut line = |line: String| {
        let _ = writeln!(text, "{line}");
    };
    line("| instructions, Cortex-M4 | 16x8 wide | 16x8 packed | 8x8 compact | 16x8, portable Rust |".into());
    line("|---|---|---|---|---|".into());
    for (name, what) in MODES {
        let [wide, packed, compact, portable] =
            ["", "_packed", "_compact", "_portable"].map(|mode| figure(&format!("{name}{mode}")));
        line(format!("| {what} | {wide} | {packed} | {compact} | {portable} |"));
    }
    let mut what = "both networks of a bearing with their features, a sample";
    for material in BearingMaterial::ALL {
        let pair = figure(&format!("pair_{}", material.name()));
        line(format!("| {what}: {} | {pair} | | | |", material.title()));
        what = "the same";
    }
    line(format!(
        "| whole controller tick of bench B | {}-{} | | | |",
        counts.estimator_tick_min, counts.estimator_tick_max
    ));
    line(format!(
        "| the same over disturbed samples (jumps, gaps, wrong times, missing values), the largest \
         | {} | | | |",
        counts.disturbed_tick_max
    ));
    line(String::new());
    line(
        "| instructions per multiply-accumulate, at one / two positions \
         | 16x8 wide | 16x8 packed | 8x8 compact |"
            .into(),
    );
    line("|---|---|---|---|".into());
    for shape in CONVOLUTIONS {
        let [wide, packed, compact] = ["wide", "packed", "compact"].map(|mode| {
            let [one, two] = [1, 2].map(|at| ratio(&format!("convolution_{shape}_{mode}_{at}")));
            format!("{one} / {two}")
        });
        line(format!("| convolution {} | {wide} | {packed} | {compact} |", shape.replace("_to_", " -> ")));
    }
    for shape in HEADS {
        let [wide, packed, compact] =
            ["wide", "packed", "compact"].map(|mode| ratio(&format!("head_{shape}_{mode}")));
        line(format!("| dense {shape} -> 1 | {wide} | {packed} | {compact} |"));
    }
    line(String::new());
    line(format!(
        "RAM of a pair: {} bytes. Flash of the smallest estimating image, with model: {} bytes.",
        counts.pair_ram_bytes, counts.smallest_flash_bytes
    ));
    text
}
