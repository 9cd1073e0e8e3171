//! Usage section of a card: accuracy in the bench's loop, and limits of the image with figures.

use super::facts::Facts;
use crate::evaluate::bench_loop::{LoopSet, Spread};
use crate::evaluate::limits::RATE_ERROR_M_S;
use crate::evaluate::verdict::Verdict;
use inference::{BearingMaterial, WINDOW};
use std::fmt::{Result, Write};

pub(super) fn write(out: &mut String, facts: &Facts<'_>) -> Result {
    write_loop(out, facts)?;
    write_limits(out, facts)
}

fn write_loop(out: &mut String, facts: &Facts<'_>) -> Result {
    writeln!(out, "\n## Accuracy in the bench's loop and with noisy sensors\n")?;
    let Some(found) = facts.bench_loop else {
        return writeln!(
            out,
            "Not measured with this image. `host-sim accuracy` measures it and writes `bench-loop.json`; \
             `model-quant quantize --bench-loop` copies it here."
        );
    };
    writeln!(
        out,
        "Bench B with the networks in place of the law (zero-order hold of {} us), and the estimator with \
         sensor noise of .2 um and .01 deg at 10 kHz, seed {}. The figures are median / largest over the \
         runs; `host-sim accuracy` measures them.\n",
        found.step_us, found.seed
    )?;
    let (paper, held_out) = (&found.paper, &found.held_out);
    writeln!(
        out,
        "| | the paper's clearances and loads, {} runs | held-out conditions, {} runs |\n|---|---|---|",
        paper.runs, held_out.runs
    )?;
    let percent: fn(&Spread) -> String = |s| format!("{:.2} / {:.2} %", 100.0 * s.median, 100.0 * s.largest);
    let torque: fn(&Spread) -> String = |s| format!("{:.1} / {:.1} N m", s.median, s.largest);
    type Row = (&'static str, fn(&LoopSet) -> &Spread, fn(&Spread) -> String);
    let rows: [Row; 6] = [
        ("peak force, change by the networks (goal 2 %)", |s| &s.peak_change, percent),
        ("oscillation rms, change by the networks (goal 5 %)", |s| &s.oscillation_change, percent),
        ("oscillation rms, change by the zero-order hold alone", |s| &s.held_oscillation_change, percent),
        ("estimator, force error in % of full scale (goal 3 %)", |s| &s.force_error, percent),
        ("described law at the estimated contact", |s| &s.law_force_error, percent),
        ("estimator, friction torque error", |s| &s.torque_error_nm, torque),
    ];
    for (name, read, format) in rows {
        writeln!(out, "| {name} | {} | {} |", format(read(paper)), format(read(held_out)))?;
    }
    writeln!(
        out,
        "\nAt the estimated contact the described law, without the factors that the filter has learnt, has a \
         smaller error than the estimate in {} of {} runs.",
        paper.law_wins + held_out.law_wins,
        paper.runs + held_out.runs
    )
}

/// Errors in the lowest force bands, relative to the mean force there.
fn light_contact(verdict: &Verdict) -> String {
    let mut low = 0.0;
    let bands = verdict.bands.iter().take(2).map(|band| {
        let text = format!(
            "{:.1} % of the force between {low} and {} N",
            100.0 * band.mae_n / band.mean_force_n,
            band.up_to_n
        );
        low = band.up_to_n;
        text
    });
    bands.collect::<Vec<_>>().join(", ")
}

fn write_limits(out: &mut String, facts: &Facts<'_>) -> Result {
    let limits = facts.limits;
    writeln!(out, "\n## Known limits\n")?;
    writeln!(
        out,
        "* The networks reproduce the hybrid law as printed and an assumed dry friction, not a measured \
         bearing. The difference between a real bearing and these laws is an error of the estimate."
    )?;
    writeln!(
        out,
        "* Dry contact only: no oil film, no temperature, no wear. \
         No tilt: the load is uniform along the bearing."
    )?;
    for verdict in facts.verdicts {
        let what = if verdict.network == "collision" { "normal force" } else { "friction" };
        writeln!(out, "* Light contact, {what}: the mean absolute error is {}.", light_contact(verdict))?;
    }
    if let Some(friction) = facts.verdicts.iter().find(|v| v.network == "friction") {
        writeln!(
            out,
            "* Friction goes to 0 with the sliding speed, so its relative error is largest below 1 mm/s. At \
             the bench's working points 95 % of the rows are within {:.2} %.",
            100.0 * friction.working_error_p95
        )?;
    }
    let beyond: Vec<String> = (limits.beyond.iter())
        .map(|(factor, error)| format!("{:+.0} % at {factor} times", 100.0 * error))
        .collect();
    writeln!(
        out,
        "* Beyond the training range the networks extrapolate. With a static deformation beyond the end of \
         the range the error of the normal force is {} the end. Every such estimate is flagged.",
        beyond.join(", ")
    )?;
    writeln!(
        out,
        "* The ratio of rate to approach speed is clamped to the range, \
         so the damping no longer grows beyond it. This affects {:.2} % of the bench's contact samples.",
        100.0 * limits.outside.rate_ratio
    )?;
    writeln!(
        out,
        "* Noise of the rate: an error of {} mm/s changes the force by {:.0} % (at 5 kN, approach speed at \
         its floor). The damping of the law causes it, so the analytic law has the same error; see above.",
        1e3 * RATE_ERROR_M_S,
        100.0 * limits.rate_error
    )?;
    writeln!(
        out,
        "* The approach speed is held from the onset of contact on. A controller that did not see the \
         onset estimates the speed from the force's damping."
    )?;
    writeln!(
        out,
        "* The first {} estimates after a start or a gap in the samples have an incomplete history and are \
         flagged.",
        WINDOW - 1
    )?;
    if facts.checkpoint.bearing == BearingMaterial::Plastic {
        writeln!(
            out,
            "* Plastic is soft: at small clearance and light load its oscillation is small (6 N rms at \
             .1 mm and -5 kN), so a small error of the force is a large share of it."
        )?;
    }
    writeln!(out, "* Not a safety function.")
}
