//! Pictures of the paper's series: Figs. 16-20, and the causes of what its claims describe.

use super::runs::{PaperRun, PaperRuns, Series};
use crate::cli::error::CliError;
use crate::cli::output::Picture;
use crate::reproduction::claims::facts::{BearingFacts, Facts, RunFacts};
use crate::reproduction::swing::power_law;
use crate::run::conditions::BEARINGS;
use crate::run::summary::after_start;
use bench::plants::transmission::Snapshot;
use model_quant::report::claims::torque::TorqueCurve;
use report::figure::{Chart, Series as Curve, Style, lines, lines_log_log};

const HALF: (u32, u32) = (512, 340);

/// Legend text of a run.
fn label(series: Series, run: &PaperRun) -> String {
    match series {
        Series::Clearance => format!("{} mm", run.figures.clearance_mm),
        Series::Load => format!("{:+} kN", run.figures.load_kn),
    }
}

fn chart<'a>(title: &'a str, x: &'a str, y: &'a str) -> Chart<'a> {
    Chart { title, x, y, size: HALF }
}

/// Draws motion and forces over time: one line per run, one picture per quantity and bearing.
pub(crate) fn over_time(runs: &PaperRuns, series: Series) -> Result<Vec<Picture>, CliError> {
    type Reading = fn(&Snapshot) -> f64;
    let quantities: [(&str, &str, &str, Reading); 4] = [
        ("impact-force", "Impact force", "N", |s| s.forces.normal_n),
        ("force-y", "Force along Y", "N", |s| s.force_y_n),
        ("force-z", "Force along Z", "N", |s| s.force_z_n),
        ("friction-torque", "Friction torque", "N m", |s| s.friction_torque_nm),
    ];
    let (stem, figures) = match series {
        Series::Clearance => ("clearance", ["Fig. 17", "Fig. 18"]),
        Series::Load => ("load", ["Fig. 19", "Fig. 20"]),
    };
    let mut pictures = motion(runs, series, stem)?;
    for (bearing, figure) in BEARINGS.into_iter().zip(figures) {
        let mut of_bearing = runs.of_bearing(series, bearing);
        if series == Series::Clearance {
            // The largest first, so that the smallest oscillation is drawn on top.
            of_bearing.reverse();
        }
        for (name, what, unit, read) in quantities {
            let curves: Vec<Curve> = of_bearing
                .iter()
                .map(|run| {
                    let samples = after_start(&run.bench, &run.samples);
                    let (x, y) = (samples.iter().map(|s| s.time_s), samples.iter().map(read));
                    Curve::new(label(series, run), x, y)
                })
                .collect();
            let title = format!("{what}, {}", bearing.name());
            let caption = match (name, series) {
                ("impact-force", _) => format!("{figure}: normal force of the contact."),
                ("friction-torque", _) => {
                    format!("{figure}: torque of the bearing on the shaft, negative while it turns forward.")
                }
                _ => format!("{figure}: component of the bearing's force on the journal."),
            };
            pictures.push(Picture::draw(
                lines,
                &format!("{stem}-{}-{name}", bearing.name()),
                &chart(&title, "time, s", unit),
                &curves,
                &caption,
            )?);
        }
    }
    Ok(pictures)
}

/// Fig. 16: speed and acceleration of the shaft, Babbitt.
fn motion(runs: &PaperRuns, series: Series, stem: &str) -> Result<Vec<Picture>, CliError> {
    let mut babbitt = runs.of_bearing(series, BEARINGS[0]);
    if series == Series::Clearance {
        babbitt.reverse();
    }
    let speed = |run: &&PaperRun| {
        let samples = after_start(&run.bench, &run.samples);
        Curve::new(
            label(series, run),
            samples.iter().map(|s| s.time_s),
            samples.iter().map(|s| s.speed_rad_s),
        )
    };
    let acceleration = |run: &&PaperRun| Curve::through(label(series, run), run.joint_acceleration());
    Ok(vec![
        Picture::draw(
            lines,
            &format!("{stem}-shaft-speed"),
            &chart("Angular velocity of the shaft, babbitt", "time, s", "rad/s"),
            &babbitt.iter().map(speed).collect::<Vec<_>>(),
            "Fig. 16: given by the drive; the swinging journal ripples on it.",
        )?,
        Picture::draw(
            lines,
            &format!("{stem}-joint-acceleration"),
            &chart("Angular acceleration of the shaft, babbitt", "time, s", "rad/s2"),
            &babbitt.iter().map(acceleration).collect::<Vec<_>>(),
            "Joint acceleration: the swinging journal moves the crank's pivot.",
        )?,
    ])
}

/// Line of a fitted power law over the range of its points.
fn fit(points: &[(f64, f64)], name: &str) -> Option<Curve> {
    let (exponent, factor) = power_law(points)?;
    let line = points.iter().map(|(x, _)| (*x, factor * x.powf(exponent))).collect();
    Some(Curve::through(format!("{name} {exponent:+.2}"), line))
}

/// Draws the effect of the clearance, and the cause of the fluctuation's frequency.
pub(crate) fn over_clearance(runs: &PaperRuns, facts: &Facts) -> Result<Vec<Picture>, CliError> {
    let both = [&facts.babbitt, &facts.plastic];
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
        vec![Curve::through("babbitt, .5 mm", gigapascals(&facts.modulus)).styled(Style::Points)];
    modulus.extend(fit(&gigapascals(&facts.modulus), "exponent"));
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
            &chart("Oscillation over clearance", "radial clearance, mm", "N rms"),
            &both.map(|b| over("", b, |r| Some(r.oscillation_n))),
            "After the first sign change of the angular acceleration.",
        )?,
        Picture::draw(
            lines,
            "clearance-peak-force",
            &chart("Peak impact force over clearance", "radial clearance, mm", "N"),
            &both.map(|b| over("", b, |r| Some(r.peak_n))),
            "Largest normal force after the start.",
        )?,
        Picture::draw(
            lines_log_log,
            "swing-over-clearance",
            &chart("Swing frequency over clearance", "radial clearance, mm", "Hz"),
            &swing,
            "Both axes logarithmic. A pendulum of the clearance's radius has the exponent -1/2.",
        )?,
        Picture::draw(
            lines_log_log,
            "swing-over-modulus",
            &chart("Swing frequency over the bearing's modulus", "modulus, GPa", "Hz"),
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
            &chart("Friction torque on the rig", "sliding speed, mm/s", "N m"),
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
    let both = [&facts.babbitt, &facts.plastic];
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
            &chart("Peak impact force over load", "load along +Y, kN", "N"),
            &force,
            "Points: these runs. Lines: the analytic law on a grid of .5 kN.",
        )?,
        Picture::draw(
            lines,
            "load-peak-torque",
            &chart("Peak friction torque over load", "load along +Y, kN", "N m"),
            &torque,
            "Largest magnitude after the start.",
        )?,
        Picture::draw(
            lines,
            "load-deformation",
            &chart("Largest deformation over load", "load along +Y, kN", "um"),
            &deformation,
            "Depth of the journal in the bearing.",
        )?,
    ])
}
