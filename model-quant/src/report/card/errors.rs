//! Error tables of a card: against the law by force, and for each quantisation step.

use super::facts::Facts;
use crate::evaluate::errors::{Errors, FRICTION_RADIUS_M};
use crate::evaluate::layers::LAYER_ROWS;
use crate::evaluate::verdict::BANDS_N;
use crate::evaluate::verify::{WORKING_FORCE_N, WORKING_RATIO};
use std::fmt::{Result, Write};

pub(super) fn write(out: &mut String, facts: &Facts<'_>) -> Result {
    writeln!(out, "## Errors against the law\n")?;
    let [low, high] = WORKING_FORCE_N;
    for verdict in facts.verdicts {
        writeln!(out, "### {}\n", verdict.network)?;
        writeln!(
            out,
            "R^2 {:.6} (float {:.6}); mean absolute error {:.1} N, of which quantisation {:.1} N; \
             {} test rows.",
            verdict.r2_quantised, verdict.r2_float, verdict.mae_n, verdict.mae_quantisation_n, verdict.rows
        )?;
        writeln!(
            out,
            "At {low} to {high} N and rate ratios up to {WORKING_RATIO}: median relative error {:.2} %, \
             95 % below {:.2} %.",
            100.0 * verdict.working_error_median,
            100.0 * verdict.working_error_p95
        )?;
        if verdict.network == "collision" {
            writeln!(
                out,
                "The mean absolute error is {:.3} % of the 99th percentile of the force, {:.0} N.",
                100.0 * verdict.mae_share_of_p99,
                verdict.p99_force_n
            )?;
        }
        if let Some(mae_nm) = verdict.mae_nm {
            writeln!(
                out,
                "As a torque on a radius of {FRICTION_RADIUS_M} m the mean absolute error is {mae_nm:.3} N m."
            )?;
        }
        if let Some(held_out) = &verdict.held_out {
            let Errors { rows, r2, mae_n, largest_n, .. } = held_out.image;
            writeln!(
                out,
                "Over {rows} samples of {} held-out bench runs: R^2 {r2:.6} (float {:.6}), \
                 mean absolute error {mae_n:.1} N, largest {largest_n:.0} N.",
                held_out.runs, held_out.float.r2
            )?;
        }
        for goal in verdict.goals.iter().filter(|goal| !goal.met) {
            writeln!(
                out,
                "Goal not met: {} is {:.6}, expected {} {}.",
                goal.figure, goal.value, goal.relation, goal.limit
            )?;
        }
        writeln!(
            out,
            "Largest output without contact {} N; rows with a clipped activation {:.3} %.\n",
            verdict.zero_contact_output,
            100.0 * verdict.saturated_share
        )?;
        writeln!(
            out,
            "| normal force up to, N | rows | mean abs. error, N | float | largest, N | \
             quantisation, mean | largest |\n|---|---|---|---|---|---|---|"
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

fn write_layers(out: &mut String, facts: &Facts<'_>) -> Result {
    writeln!(out, "## Quantisation error by step\n")?;
    writeln!(
        out,
        "One step at a time in fixed point, everything else in floats; mean / largest change of the force \
         in N over {LAYER_ROWS} test rows, by normal force. \"Trained on\" (the grid) are the weights of \
         the image; the other rows for weights round those of the float networks. \
         `model-quant quantize --layers` prints this table for every mode.\n"
    )?;
    let bands: String = BANDS_N.iter().map(|up_to| format!(" to {up_to} N |")).collect();
    writeln!(out, "| network | in fixed point | all |{bands} above |")?;
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
