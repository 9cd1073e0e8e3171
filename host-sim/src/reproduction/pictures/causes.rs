//! Figures of the runs over clearance, load, modulus and speed: the causes of what the claims
//! describe.

use super::chart;
use crate::cli::error::CliError;
use crate::cli::output::Picture;
use crate::reproduction::claims::facts::{BearingFacts, Facts, RunFacts};
use crate::reproduction::runs::{PaperRuns, Series};
use crate::reproduction::swing::power_law;
use crate::run::conditions::BEARINGS;
use model_quant::report::claims::torque::TorqueCurve;
use report::figure::{Series as Curve, Style, lines, lines_log_log};

/// Line of a fitted power law over the range of its points.
fn fit(points: &[(f64, f64)], name: &str) -> Option<Curve> {
    let (exponent, factor) = power_law(points)?;
    let line = points.iter().map(|(x, _)| (*x, factor * x.powf(exponent))).collect();
    Some(Curve::through(format!("{name} {exponent:+.2}"), line))
}

/// Draws the effect of the clearance, and the cause of the fluctuation's frequency.
pub(crate) fn over_clearance(runs: &PaperRuns, facts: &Facts) -> Result<Vec<Picture>, CliError> {
    let both = [&facts.motion.babbitt, &facts.motion.plastic];
    let over = |name: &str, b: &BearingFacts, value: fn(&RunFacts) -> Option<f64>| {
        let points = b.clearance.iter().filter_map(|r| Some((r.clearance_mm, value(r)?))).collect();
        Curve::through(format!("{}{name}", b.bearing.name()), points).styled(Style::Both)
    };
    let mut swing: Vec<Curve> =
        both.iter().map(|b| over("", b, |r| r.swing_hz).styled(Style::Points)).collect();
    let fits: Vec<Curve> =
        swing.iter().filter_map(|c| fit(&c.points, &format!("{}, exponent", c.name))).collect();
    swing.extend(fits);
    let mut modulus =
        vec![Curve::through("babbitt, .5 mm", gigapascals(&facts.motion.modulus)).styled(Style::Points)];
    modulus.extend(fit(&gigapascals(&facts.motion.modulus), "exponent"));
    let coefficients: Vec<Curve> = BEARINGS
        .into_iter()
        .filter_map(|bearing| {
            let runs = runs.of_bearing(Series::Clearance, bearing);
            let run = runs.last()?;
            let points = run.coefficients.iter().map(|(v, c)| (1e3 * v, *c)).collect();
            Some(Curve::through(bearing.name(), points).styled(Style::Both))
        })
        .collect();
    Ok(vec![
        Picture::draw(
            lines,
            "clearance-oscillation",
            &chart("Oscillation over clearance", "radial clearance, mm", "oscillation, N rms"),
            &both.map(|b| over("", b, |r| Some(r.oscillation_n))),
            "After the first sign change of the angular acceleration.",
        )?,
        Picture::draw(
            lines,
            "clearance-peak-force",
            &chart("Peak impact force over clearance", "radial clearance, mm", "peak normal force, N"),
            &both.map(|b| over("", b, |r| Some(r.peak_n))),
            "Largest normal force after the start.",
        )?,
        Picture::draw(
            lines_log_log,
            "swing-over-clearance",
            &chart("Swing frequency over clearance", "radial clearance, mm", "swing frequency, Hz"),
            &swing,
            "Both axes logarithmic. A pendulum of the clearance's radius has the exponent -1/2.",
        )?,
        Picture::draw(
            lines_log_log,
            "swing-over-modulus",
            &chart("Swing frequency over the bearing's modulus", "modulus, GPa", "swing frequency, Hz"),
            &modulus,
            "Everything else fixed, analytic law, both axes logarithmic.",
        )?,
        Picture::draw(
            lines,
            "friction-coefficient",
            &chart(
                "Friction coefficient in the runs, 1 mm",
                "sliding speed, mm/s",
                "torque / (force radius)",
            ),
            &coefficients,
            "Friction force over normal force, mean in bands of the sliding speed.",
        )?,
        Picture::draw(
            lines,
            "friction-torque-over-speed",
            &chart("Friction torque on the rig", "sliding speed, mm/s", "friction torque, N m"),
            &torque_curves(facts),
            "Medians of simulated records with noise and outliers, both directions.",
        )?,
    ])
}

fn gigapascals(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    points.iter().map(|(pa, hz)| (pa * 1e-9, *hz)).collect()
}

fn torque_curves(facts: &Facts) -> Vec<Curve> {
    let named = |name: &str, curve: Option<&TorqueCurve>| {
        curve.map(|c| {
            let points = c.points.iter().map(|(v, t)| (1e3 * v, *t)).collect();
            Curve::through(format!("{name}, {:.0} kN", c.load_n * 1e-3), points).styled(Style::Both)
        })
    };
    let (babbitt, plastic) = (&facts.friction.babbitt, &facts.friction.plastic);
    [
        named("babbitt", babbitt.last()),
        named("plastic", plastic.last()),
        named("babbitt", babbitt.first()),
        named("plastic", plastic.first()),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Draws the effect of the load.
pub(crate) fn over_load(runs: &PaperRuns, facts: &Facts) -> Result<Vec<Picture>, CliError> {
    let both = [&facts.motion.babbitt, &facts.motion.plastic];
    let points = |b: &BearingFacts, value: fn(&RunFacts) -> f64| -> Vec<(f64, f64)> {
        b.load.iter().map(|r| (r.load_kn, value(r))).collect()
    };
    let mut force: Vec<Curve> = both
        .iter()
        .map(|b| Curve::through(b.bearing.name(), points(b, |r| r.peak_n)).styled(Style::Points))
        .collect();
    force.extend(
        both.iter()
            .map(|b| Curve::through(format!("{}, analytic law", b.bearing.name()), b.load_curve.clone())),
    );
    let torque =
        both.map(|b| Curve::through(b.bearing.name(), points(b, |r| r.peak_torque_nm)).styled(Style::Both));
    let deformation: Vec<Curve> = BEARINGS
        .into_iter()
        .map(|bearing| {
            let of = runs.of_bearing(Series::Load, bearing);
            let points = of.iter().map(|r| (r.figures.load_kn, r.figures.max_deformation_m * 1e6)).collect();
            Curve::through(bearing.name(), points).styled(Style::Both)
        })
        .collect();
    Ok(vec![
        Picture::draw(
            lines,
            "load-peak-force",
            &chart("Peak impact force over load", "load along +Y, kN", "peak normal force, N"),
            &force,
            "Points: these runs. Lines: the analytic law on a grid of .5 kN.",
        )?,
        Picture::draw(
            lines,
            "load-peak-torque",
            &chart("Peak friction torque over load", "load along +Y, kN", "peak torque, N m"),
            &torque,
            "Largest magnitude after the start.",
        )?,
        Picture::draw(
            lines,
            "load-deformation",
            &chart("Largest deformation over load", "load along +Y, kN", "deformation, um"),
            &deformation,
            "Depth of the journal in the bearing.",
        )?,
    ])
}
