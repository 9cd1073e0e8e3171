//! The model card: what an image is, what it was trained on and how wrong it is, in newtons.

use crate::checkpoint::Checkpoint;
use crate::net::Net;
use crate::quantise::CALIBRATION_ROWS;
use crate::ranges::RangeKind;
use crate::verify::{Verdict, WORKING_FORCE_N, WORKING_RATIO};
use inference::Header;
use inference::layout::{COLLISION_TAPS, FRICTION_TAPS, IMAGE_LENGTH, WINDOW, macs_per_step};
use std::fmt::Write;

/// Writes the card of an image as Markdown.
pub fn card(checkpoint: &Checkpoint, header: &Header, verdicts: &[Verdict]) -> String {
    let mut text = String::new();
    // Writing to a string does not fail.
    let _ = write_card(&mut text, checkpoint, header, verdicts);
    text
}

fn write_card(
    out: &mut String,
    checkpoint: &Checkpoint,
    header: &Header,
    verdicts: &[Verdict],
) -> std::fmt::Result {
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
    writeln!(
        out,
        "| image | `{name}.pintle`, {IMAGE_LENGTH} bytes, format {}, CRC-32 {:08x} |",
        header.format_version, header.crc
    )?;
    writeln!(out, "| training id | {:016x} |", header.training_id)?;
    writeln!(
        out,
        "| parameters | {} collision, {} friction |",
        Net::<COLLISION_TAPS>::PARAMETERS,
        Net::<FRICTION_TAPS>::PARAMETERS
    )?;
    writeln!(
        out,
        "| multiply-accumulates a sample | {} collision, {} friction |",
        macs_per_step(COLLISION_TAPS),
        macs_per_step(FRICTION_TAPS)
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
        ("radial clearance, mm", header.radial_clearance_m, 1e3),
        ("deformation, um", header.deformation_m, 1e6),
        ("rate over approach speed", header.rate_ratio, 1.0),
        ("sliding speed, m/s", header.sliding_speed_m_s, 1.0),
        ("normal force, N", header.normal_force_n, 1.0),
    ] {
        let [low, high] = [range.low, range.high].map(|end| tidy(f64::from(end) * factor));
        writeln!(out, "| {input} | {low} | {high} |")?;
    }
    writeln!(
        out,
        "\nThe latched approach speed has a floor of {} mm/s.",
        tidy(f64::from(header.latch_floor_m_s) * 1e3)
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
            "| normal force up to, N | rows | mean abs. error, N | float | largest, N |\n|---|---|---|---|---|"
        )?;
        for band in &verdict.bands {
            writeln!(
                out,
                "| {} | {} | {:.1} | {:.1} | {:.0} |",
                band.up_to_n, band.rows, band.mae_n, band.mae_float_n, band.largest_n
            )?;
        }
        writeln!(out)?;
    }
    Ok(())
}

/// Rounds away what a change of unit leaves behind in an f32.
fn tidy(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}
