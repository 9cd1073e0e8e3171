//! The card's plain words: what the image is worth in use, and where it stops being right, with numbers.

use super::Facts;
use crate::bench_loop::{LoopSet, Spread};
use crate::limits::RATE_ERROR_M_S;
use crate::verify::Verdict;
use inference::{Bearing, WINDOW};
use std::fmt::{Result, Write};

pub(super) fn write(out: &mut String, facts: &Facts<'_>) -> Result {
    write_loop(out, facts)?;
    write_limits(out, facts)
}

fn write_loop(out: &mut String, facts: &Facts<'_>) -> Result {
    writeln!(out, "\n## In the bench's loop and behind noisy sensors\n")?;
    let Some(found) = facts.bench_loop else {
        return writeln!(
            out,
            "Not measured with this image. `host-sim accuracy` measures it and writes `bench-loop.json`; \
             `model-quant quantize --bench-loop` puts it here."
        );
    };
    writeln!(
        out,
        "Bench B with the networks in place of the law, held for {} us; the estimator with sensor noise of .2 um and .01 deg at\n\
         10 kHz, seed {}. Median / largest over the runs; `host-sim accuracy` measures it again.\n",
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
        ("oscillation rms, change by the held step alone", |s| &s.held_oscillation_change, percent),
        ("estimator, force error of full scale (goal 3 %)", |s| &s.force_error, percent),
        ("analytic law on the same signals", |s| &s.law_force_error, percent),
        ("estimator, friction torque error", |s| &s.torque_error_nm, torque),
    ];
    for (name, read, format) in rows {
        writeln!(out, "| {name} | {} | {} |", format(read(paper)), format(read(held_out)))?;
    }
    writeln!(
        out,
        "\nOn the same signals the analytic law errs less than the networks in {} of {} runs.",
        paper.law_wins + held_out.law_wins,
        paper.runs + held_out.runs
    )
}

/// Errors in the lowest bands of the force, relative to the mean force there.
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
        "* It knows the law, not the bearing: the hybrid law as printed and a stated dry friction. Where a real bearing differs from\n  \
           them, the estimate differs as much."
    )?;
    writeln!(
        out,
        "* Dry contact only: no oil film, no temperature, no wear. No tilt: the load is even along the bearing."
    )?;
    for verdict in facts.verdicts {
        let what = if verdict.network == "collision" { "normal force" } else { "friction" };
        writeln!(out, "* Light contact, {what}: the mean absolute error is {}.", light_contact(verdict))?;
    }
    if let Some(friction) = facts.verdicts.iter().find(|v| v.network == "friction") {
        writeln!(
            out,
            "* Friction goes to 0 with the sliding speed, so its relative error is largest below 1 mm/s; at the bench's working\n  \
             points 95 % of the rows are within {:.2} %.",
            100.0 * friction.working_error_p95
        )?;
    }
    let beyond: Vec<String> = (limits.beyond.iter())
        .map(|(factor, error)| format!("{:+.0} % at {factor} times", 100.0 * error))
        .collect();
    writeln!(
        out,
        "* Beyond the training range it extrapolates: with a deformation deeper than the range at rest the normal force is off by\n  \
           {} its end. Every such estimate is flagged.",
        beyond.join(", ")
    )?;
    writeln!(
        out,
        "* The rate over the approach speed is limited to the range: beyond it the damping no longer grows; {:.2} % of the bench's\n  \
           samples in contact are there.",
        100.0 * limits.outside.rate_ratio
    )?;
    writeln!(
        out,
        "* Noise of the rate: {} mm/s of error changes the force by {:.0} % (at 5 kN, approach speed at its floor). That is the law's\n  \
           own damping; see above what the law makes of the same signals.",
        1e3 * RATE_ERROR_M_S,
        100.0 * limits.rate_error
    )?;
    writeln!(
        out,
        "* The approach speed is latched at the onset. Switched on in contact, a controller has not seen it and takes the configured one."
    )?;
    writeln!(
        out,
        "* The first {} estimates after a start or a gap in the samples lack history and are flagged.",
        WINDOW - 1
    )?;
    if facts.checkpoint.bearing == Bearing::Plastic {
        writeln!(
            out,
            "* Plastic is soft: at small clearance and light load its oscillation is small (6 N rms at .1 mm and -5 kN), and a small error of the force is a\n  \
               large share of it."
        )?;
    }
    writeln!(out, "* Not a safety function.")
}
