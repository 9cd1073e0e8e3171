//! The model card: what an image is, what it was trained on and how wrong it is, in newtons.

use crate::checkpoint::Checkpoint;
use crate::layers::{LAYER_ROWS, LayerError};
use crate::mode::Plan;
use crate::quantise::CALIBRATION_ROWS;
use crate::ranges::RangeKind;
use crate::shapes::{collision, friction};
use crate::verify::{BANDS_N, Verdict, WORKING_FORCE_N, WORKING_RATIO};
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
}

/// Writes the card of an image as Markdown.
pub fn card(facts: &Facts<'_>) -> String {
    let mut text = String::new();
    // Writing to a string does not fail.
    let _ = write_card(&mut text, facts);
    text
}

fn write_card(out: &mut String, facts: &Facts<'_>) -> std::fmt::Result {
    let Facts { checkpoint, plan, header, image, verdicts, .. } = *facts;
    let recipe = &checkpoint.recipe;
    let name = checkpoint.bearing.name();
    let range = match recipe.range {
        RangeKind::Bench => "bench",
        RangeKind::Paper => "paper",
    };
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
        "| recipe | range `{range}`, seed {}, {} rows, {} epochs free and {} freezing, batch {}, Adam {:e} and {:e} |",
        recipe.seed,
        recipe.rows,
        recipe.epochs,
        recipe.grid_epochs,
        recipe.batch,
        recipe.learning_rate,
        recipe.grid_learning_rate
    )?;
    writeln!(out, "| calibration | min-max over {CALIBRATION_ROWS} rows of the same range and seed |\n")?;
    writeln!(out, "## Training range\n\n| input | from | to |\n|---|---|---|")?;
    for (input, range, factor) in [
        ("radial clearance, mm", header.radial_clearance_m(), 1e3),
        ("deformation, um", header.deformation_m(), 1e6),
        ("rate over approach speed", header.rate_ratio(), 1.0),
        ("sliding speed, m/s", header.sliding_speed_m_s(), 1.0),
        ("normal force, N", header.normal_force_n(), 1.0),
    ] {
        let [low, high] = [range.low, range.high].map(|end| tidy(f64::from(end) * factor));
        writeln!(out, "| {input} | {low} | {high} |")?;
    }
    writeln!(
        out,
        "\nThe latched approach speed has a floor of {} mm/s.",
        tidy(f64::from(header.latch_floor_m_s()) * 1e3)
    )?;
    writeln!(out, "Outside these ranges the estimate is flagged, not made right.\n")?;
    writeln!(out, "## Errors against the law\n")?;
    let [low, high] = WORKING_FORCE_N;
    for verdict in verdicts {
        writeln!(out, "### {}\n", verdict.network)?;
        writeln!(
            out,
            "R^2 {:.6} (float {:.6}); mean absolute error {:.1} N, of which quantisation {:.1} N; {} test rows.",
            verdict.r2_quantised, verdict.r2_float, verdict.mae_n, verdict.mae_quantisation_n, verdict.rows
        )?;
        writeln!(
            out,
            "At {low} to {high} N and rate ratios up to {WORKING_RATIO}: median relative error {:.2} %, 95 % below {:.2} %.",
            100.0 * verdict.working_error_median,
            100.0 * verdict.working_error_p95
        )?;
        writeln!(
            out,
            "Largest output without contact {} N; rows with a clipped activation {:.3} %.\n",
            verdict.zero_contact_output,
            100.0 * verdict.saturated_share
        )?;
        writeln!(
            out,
            "| normal force up to, N | rows | mean abs. error, N | float | largest, N | quantisation, mean | largest |\n|---|---|---|---|---|---|---|"
        )?;
        for band in &verdict.bands {
            writeln!(
                out,
                "| {} | {} | {:.1} | {:.1} | {:.0} | {:.1} | {:.0} |",
                band.up_to_n,
                band.rows,
                band.mae_n,
                band.mae_float_n,
                band.largest_n,
                band.mae_quantisation_n,
                band.largest_quantisation_n
            )?;
        }
        writeln!(out)?;
    }
    write_layers(out, facts)
}

fn write_layers(out: &mut String, facts: &Facts<'_>) -> std::fmt::Result {
    writeln!(out, "## Where the quantisation error comes from\n")?;
    writeln!(
        out,
        "One step at a time in whole numbers, everything else in floats; mean / largest change of the force in N over\n\
         {LAYER_ROWS} test rows, by normal force. \"Trained on\" are the weights that the image has; the other lines of weights round\n\
         those of the float networks. `model-quant quantize --layers` prints this for every mode.\n"
    )?;
    let bands: String = BANDS_N.iter().map(|up_to| format!(" to {up_to} N |")).collect();
    writeln!(out, "| network | in whole numbers | all |{bands} above |")?;
    writeln!(out, "|---|---|---|{}", "---|".repeat(BANDS_N.len() + 1))?;
    for layer in facts.layers {
        write!(out, "| {} | {} | {:.2} |", layer.network, layer.quantised, layer.mae_n)?;
        for band in &layer.bands {
            write!(out, " {:.2} / {:.1} |", band.mae_n, band.largest_n)?;
        }
        writeln!(out)?;
    }
    Ok(())
}

/// Rounds away what a change of unit leaves behind in an f32.
fn tidy(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}
