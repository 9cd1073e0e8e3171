//! The model card: what an image is, what it was trained on, how wrong it is, in newtons, and where it stops being right.
//!
//! [`errors`] holds the tables of errors, [`limits`] the bench's loop and the limits in plain words.

mod errors;
mod limits;

use crate::bench_loop::BenchLoop;
use crate::checkpoint::Checkpoint;
use crate::layers::LayerError;
use crate::limits::Limits;
use crate::mode::Plan;
use crate::quantise::CALIBRATION_ROWS;
use crate::recipe::TrainingSet;
use crate::shapes::{collision, friction};
use crate::verify::{TEST_ROWS, Verdict};
use inference::image::{CRC_LENGTH, FORMAT_VERSION};
use inference::{Header, WINDOW};
use std::fmt::Write;

/// What a card tells of.
#[derive(Clone, Copy, Debug)]
pub struct Facts<'a> {
    /// What the image was made from.
    pub checkpoint: &'a Checkpoint,
    /// How.
    pub plan: Plan,
    /// The image's header.
    pub header: &'a Header,
    /// The image.
    pub image: &'a [u8],
    /// What verification found.
    pub verdicts: &'a [Verdict],
    /// What each layer's quantisation costs.
    pub layers: &'a [LayerError],
    /// Where the image stops being right.
    pub limits: &'a Limits,
    /// What it is worth in the bench's loop, where that was measured with this very image.
    pub bench_loop: Option<&'a BenchLoop>,
}

/// Writes the card of an image as Markdown.
pub fn card(facts: &Facts<'_>) -> String {
    let mut text = String::new();
    // Writing to a string does not fail.
    let _ = write_card(&mut text, facts);
    text
}

fn write_card(out: &mut String, facts: &Facts<'_>) -> std::fmt::Result {
    let Facts { checkpoint, plan, header, image, .. } = *facts;
    let recipe = &checkpoint.recipe;
    let name = checkpoint.bearing.name();
    writeln!(out, "# Model card: {name}\n")?;
    writeln!(
        out,
        "Two causal 1-D convolutional networks in one image: contact state to normal force (collision), and"
    )?;
    writeln!(
        out,
        "normal force and sliding speed to friction. Written by `model-quant quantize`; do not edit.\n"
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
    writeln!(
        out,
        "| parameters | {} collision, {} friction |",
        collision().parameters(),
        friction().parameters()
    )?;
    writeln!(
        out,
        "| multiply-accumulates a sample | {} collision, {} friction |",
        collision().macs_per_step(),
        friction().macs_per_step()
    )?;
    writeln!(out, "| window | {WINDOW} samples; the first {} after a reset are flagged |", WINDOW - 1)?;
    writeln!(
        out,
        "| laws | hybrid normal law as printed, Zhiying-Qishao dissipation; dry friction of the bench |"
    )?;
    writeln!(
        out,
        "| training | {} epochs free and {} on the 8-bit grid, batch {}, Adam {:e} and {:e}, instruction set `{}` |",
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
        "Rows of the range `{range}` below with seed {}, forces from the laws. To train on: {training}; to validate {} rows, to\n\
         test {TEST_ROWS}. Every row has a stream of its own by seed, purpose and index: none of one part is in another.\n\
         No measurement entered; the paper published none.\n",
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
        "Bench runs: samples in contact of bench B at .1, .25, .5 and 1 mm and loads of 1, 5 and 10 kN either way; deepest\n\
         contact {:.0} um; {:.2} % of the samples are outside in any input.",
        1e6 * outside.deepest_m,
        100.0 * outside.any
    )?;
    writeln!(out, "Outside these ranges the estimate is flagged, not made right.\n")?;
    errors::write(out, facts)?;
    limits::write(out, facts)
}

/// Rounds away what a change of unit leaves behind in an f32.
fn tidy(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}
