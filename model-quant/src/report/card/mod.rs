//! Model card: content of an image, its training, its errors in newtons and its limits.
//!
//! `errors` writes the error tables, `limits` the accuracy in the bench's loop and the limits.

mod errors;
mod facts;
mod limits;

pub use facts::Facts;

use crate::evaluate::test_set::TEST_ROWS;
use crate::network::NetworkKind;
use crate::network::recipe::TrainingSet;
use crate::quantise::CALIBRATION_ROWS;
use inference::WINDOW;
use inference::image::{CRC_LENGTH, FORMAT_VERSION};
use std::fmt::Write;

/// Maximum width of a line of prose.
const WIDTH: usize = 100;

/// Writes the card of an image as Markdown.
pub fn card(facts: &Facts<'_>) -> String {
    let mut text = String::new();
    // Writing to a string does not fail.
    let _ = write_card(&mut text, facts);
    wrapped(&text)
}

/// Breaks prose and list items, but no tables, into lines of at most [`WIDTH`] characters.
fn wrapped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for line in text.lines() {
        let indent = if line.starts_with("* ") { "  " } else { "" };
        let mut width = 0;
        for word in line.split(' ') {
            if width > 0 && width + 1 + word.len() > WIDTH && !line.starts_with('|') {
                out.push('\n');
                out.push_str(indent);
                width = indent.len();
            } else if width > 0 {
                out.push(' ');
                width += 1;
            }
            out.push_str(word);
            width += word.len();
        }
        out.push('\n');
    }
    out
}

fn write_card(out: &mut String, facts: &Facts<'_>) -> std::fmt::Result {
    let Facts { checkpoint, plan, header, image, .. } = *facts;
    let recipe = &checkpoint.recipe;
    let name = checkpoint.bearing.name();
    writeln!(out, "# Model card: {name}\n")?;
    writeln!(
        out,
        "Two causal 1-D convolutional networks in one image: from contact state to normal force (collision), \
         and from normal force and sliding speed to friction. Written by `model-quant quantize`; do not \
         edit.\n"
    )?;
    writeln!(out, "| | |\n|---|---|")?;
    let crc = image.last_chunk::<CRC_LENGTH>().map_or(0, |sum| u32::from_le_bytes(*sum));
    writeln!(
        out,
        "| image | `{name}.pintle`, {} bytes, format {FORMAT_VERSION}, CRC-32 {crc:08x} |",
        image.len()
    )?;
    writeln!(out, "| mode | {}, packed for {} |", plan.mode.name(), plan.packing.name())?;
    writeln!(out, "| training id | {:016x} |", header.training_id)?;
    let [collision, friction] = NetworkKind::ALL.map(NetworkKind::shape);
    writeln!(
        out,
        "| parameters | {} collision, {} friction |",
        collision.parameters(),
        friction.parameters()
    )?;
    writeln!(
        out,
        "| multiply-accumulates a sample | {} collision, {} friction |",
        collision.macs_per_step(),
        friction.macs_per_step()
    )?;
    writeln!(out, "| window | {WINDOW} samples; the first {} after a reset are flagged |", WINDOW - 1)?;
    writeln!(
        out,
        "| laws | hybrid normal law as printed, Zhiying-Qishao dissipation; dry friction of the bench |"
    )?;
    writeln!(
        out,
        "| training | {} epochs with free weights and {} on the 8-bit grid, batch {}, Adam {:e} and {:e}, \
         instruction set `{}` |",
        recipe.epochs,
        recipe.grid_epochs,
        recipe.batch,
        recipe.learning_rate,
        recipe.grid_learning_rate,
        recipe.instruction_set.name()
    )?;
    writeln!(out, "| calibration | min-max over {CALIBRATION_ROWS} rows of the same range and seed |\n")?;
    write_data(out, facts)?;
    write_range(out, facts)
}

fn write_data(out: &mut String, facts: &Facts<'_>) -> std::fmt::Result {
    let recipe = &facts.checkpoint.recipe;
    let range = format!("{:?}", recipe.range).to_lowercase();
    let training = match recipe.set {
        TrainingSet::Drawn => format!("{} drawn rows", recipe.rows),
        TrainingSet::Full => "all ten million rows of the collision set".to_owned(),
    };
    writeln!(out, "## Data\n")?;
    writeln!(
        out,
        "Rows of the range `{range}` below with seed {}, forces from the laws. Training: {training}; \
         validation: {} rows; test: {TEST_ROWS} rows. Every row has a separate random stream by seed, \
         purpose and index, so the parts share no rows. No measurements were used; \
         the paper published none.\n",
        recipe.seed, recipe.validation_rows
    )
}

fn write_range(out: &mut String, facts: &Facts<'_>) -> std::fmt::Result {
    writeln!(out, "## Training range\n\n| input | from | to | bench runs outside |\n|---|---|---|---|")?;
    let header = facts.header;
    let outside = &facts.limits.outside;
    for (input, range, factor, share) in [
        ("radial clearance, mm", header.radial_clearance_m(), 1e3, Some(outside.radial_clearance)),
        ("deformation, um", header.deformation_m(), 1e6, Some(outside.deformation)),
        ("rate over approach speed", header.rate_ratio(), 1.0, Some(outside.rate_ratio)),
        ("sliding speed, m/s", header.sliding_speed_m_s(), 1.0, None),
        ("normal force, N", header.normal_force_n(), 1.0, None),
    ] {
        let share = share.map_or_else(|| "-".to_owned(), |share| format!("{:.2} %", 100.0 * share));
        let [low, high] = [range.low, range.high].map(|end| tidy(f64::from(end) * factor));
        writeln!(out, "| {input} | {low} | {high} | {share} |")?;
    }
    writeln!(
        out,
        "\nThe latched approach speed has a floor of {} mm/s.",
        tidy(f64::from(header.latch_floor_m_s()) * 1e3)
    )?;
    writeln!(
        out,
        "Bench runs: contact samples of bench B at .1, .25, .5 and 1 mm and loads of 1, 5 and 10 kN in both \
         directions. The deepest contact is {:.0} um; {:.2} % of the samples are outside in any input.",
        1e6 * outside.deepest_m,
        100.0 * outside.any
    )?;
    writeln!(out, "Outside these ranges the estimate is flagged, not corrected.\n")?;
    errors::write(out, facts)?;
    limits::write(out, facts)
}

/// Rounds to seven digits: removes the f32 error of a unit conversion.
fn tidy(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}
