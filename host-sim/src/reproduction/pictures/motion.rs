//! Figs. 16 to 20: motion and forces over time, from rest and settled, with the reversal enlarged
//! and differences where curves coincide.

use super::{chart, label, label_of};
use crate::cli::error::CliError;
use crate::cli::output::Picture;
use crate::reproduction::claims::cycles::{CYCLES, Operation, SettledRun, of_operation};
use crate::reproduction::runs::{PaperRun, PaperRuns, Series, joint_acceleration};
use crate::run::conditions::BEARINGS;
use crate::run::summary::ideal_angular_acceleration;
use bench::BearingMaterial;
use bench::description::TransmissionBench;
use bench::plants::transmission::Snapshot;
use report::figure::{Series as Curve, lines};

/// Part of the period around the reversal that is enlarged.
const REVERSAL: (f64, f64) = (0.3, 0.6);
const TIME: &str = "time, s";
const SETTLED_TIME: &str = "time in the fifth cycle, s";

type Reading = fn(&Snapshot) -> f64;
/// Panels of Figs. 17 to 20: letter, file name, title, axis, quantity.
const PANELS: [(&str, &str, &str, &str, Reading); 4] = [
    ("a", "impact-force", "impact force", "normal force, N", |s| s.forces.normal_n),
    ("b", "force-y", "force along Y", "force along Y, N", |s| s.force_y_n),
    ("c", "force-z", "force along Z", "force along Z, N", |s| s.force_z_n),
    ("d", "friction-torque", "friction torque", "friction torque, N m", |s| s.friction_torque_nm),
];

/// A run in a picture: its cycle begins at `start_s`.
#[derive(Clone)]
struct Line<'a> {
    label: String,
    bench: &'a TransmissionBench,
    samples: &'a [Snapshot],
    start_s: f64,
}

/// One figure of the paper: its pictures, and the sentence about what they show.
pub(in crate::reproduction) struct PaperFigure {
    /// Heading.
    pub(in crate::reproduction) heading: String,
    /// Description of what to see.
    pub(in crate::reproduction) text: String,
    /// Pictures in pairs: from rest, settled.
    pub(in crate::reproduction) pictures: Vec<Picture>,
}

/// Draws the figures of a series: Fig. 16 and those of both bearings.
pub(in crate::reproduction) fn figures(
    runs: &PaperRuns,
    settled: &[SettledRun],
    series: Series,
) -> Result<Vec<PaperFigure>, CliError> {
    let mut figures = vec![shaft(runs, settled, series)?];
    let numbers = match series {
        Series::Clearance => [17, 18],
        Series::Load => [19, 20],
    };
    for (bearing, number) in BEARINGS.into_iter().zip(numbers) {
        figures.push(forces(&Both::new(runs, settled, series, bearing), number)?);
    }
    Ok(figures)
}

/// The runs of a bearing in both operations.
struct Both<'a> {
    series: Series,
    bearing: BearingMaterial,
    from_rest: Vec<Line<'a>>,
    settled: Vec<Line<'a>>,
}

impl<'a> Both<'a> {
    fn new(runs: &'a PaperRuns, settled: &'a [SettledRun], series: Series, bearing: BearingMaterial) -> Self {
        let of_bearing = runs.of_bearing(series, bearing);
        let mut from_rest: Vec<Line> = of_bearing.iter().map(|run| first_cycle(series, run)).collect();
        let find = |run: &&PaperRun| settled.iter().find(|other| other.has_conditions_of(&run.bench));
        let mut last: Vec<Line> =
            of_bearing.iter().filter_map(find).map(|run| last_cycle(series, run)).collect();
        if series == Series::Clearance {
            // The largest first, so that the smallest oscillation is drawn on top.
            from_rest.reverse();
            last.reverse();
        }
        Self { series, bearing, from_rest, settled: last }
    }

    fn stem(&self) -> &'static str {
        match self.series {
            Series::Clearance => "clearance",
            Series::Load => "load",
        }
    }
}

fn first_cycle(series: Series, run: &PaperRun) -> Line<'_> {
    Line { label: label(series, run), bench: &run.bench, samples: &run.samples, start_s: 0.0 }
}

fn last_cycle(series: Series, run: &SettledRun) -> Line<'_> {
    let bench = &run.bench;
    let start_s = f64::from(CYCLES - 1) * bench.drive.period_s;
    let samples = of_operation(bench, &run.samples, Operation::Settled);
    let samples = samples.get(samples.partition_point(|s| s.time_s < start_s)..).unwrap_or_default();
    let load_kn = bench.load.force_n * 1e-3;
    let label = label_of(series, bench.bearing.radial_clearance_m * 1e3, load_kn);
    Line { label, bench, samples, start_s }
}

impl Line<'_> {
    fn curve(&self, read: impl Fn(&Snapshot) -> f64) -> Curve {
        let times = self.samples.iter().map(|s| s.time_s - self.start_s);
        Curve::new(self.label.clone(), times, self.samples.iter().map(read))
    }
}

/// Adds the shaded start to curves from rest.
fn with_start(mut curves: Vec<Curve>, lines: &[Line]) -> Vec<Curve> {
    if let Some(line) = lines.first() {
        let ramp_s = line.bench.load.ramp_s;
        curves.push(Curve::shade("start: ramp of the load", (0.0, ramp_s), &curves));
    }
    curves
}

/// Keeps the part of curves around the reversal.
fn zoomed(curves: Vec<Curve>, lines: &[Line]) -> Vec<Curve> {
    let period_s = lines.first().map_or(1.0, |line| line.bench.drive.period_s);
    let within = |(time_s, _): &(f64, f64)| (REVERSAL.0 * period_s..=REVERSAL.1 * period_s).contains(time_s);
    let part = |curve: Curve| {
        let points = curve.points.into_iter().filter(within).collect();
        Curve::through(curve.name, points)
    };
    curves.into_iter().map(part).collect()
}

/// Draws the same quantity from rest and settled, side by side.
fn pair(
    name: &str,
    title: &str,
    axis: &str,
    [from_rest, settled]: [Vec<Curve>; 2],
    captions: [&str; 2],
) -> Result<[Picture; 2], CliError> {
    let settled_title = format!("{title}, settled");
    Ok([
        Picture::draw(lines, name, &chart(title, TIME, axis), &from_rest, captions[0])?,
        Picture::draw(
            lines,
            &format!("{name}-settled"),
            &chart(&settled_title, SETTLED_TIME, axis),
            &settled,
            captions[1],
        )?,
    ])
}

/// Fig. 16: speed and acceleration of the shaft, Babbitt.
fn shaft(runs: &PaperRuns, settled: &[SettledRun], series: Series) -> Result<PaperFigure, CliError> {
    let both = Both::new(runs, settled, series, BEARINGS[0]);
    let sides = [&both.from_rest, &both.settled];
    let stem = both.stem();
    let all = |curve: &dyn Fn(&Line) -> Curve| sides.map(|lines| lines.iter().map(curve).collect::<Vec<_>>());
    let shaded = |[from_rest, settled]: [Vec<Curve>; 2]| [with_start(from_rest, &both.from_rest), settled];
    let speed = all(&|line| line.curve(|s| s.speed_rad_s));
    let difference = all(&|line| line.curve(|s| s.speed_rad_s - ideal_speed(line.bench, s.time_s)));
    let acceleration = all(&|line| {
        let points = joint_acceleration(line.samples).into_iter();
        Curve::through(line.label.clone(), points.map(|(t, a)| (t - line.start_s, a)).collect())
    });
    let ideal = sides.map(|lines| {
        lines.first().map(|line| {
            let value = |s: &Snapshot| ideal_angular_acceleration(line.bench, s.time_s);
            Curve { name: "without clearance".into(), ..line.curve(value) }
        })
    });
    let [mut rest, mut last] = acceleration;
    let [ideal_rest, ideal_last] = ideal;
    rest.extend(ideal_rest);
    last.extend(ideal_last);
    let pictures = [
        pair(
            &format!("{stem}-shaft-speed"),
            "Fig. 16 Angular velocity of the shaft, babbitt",
            "angular velocity, rad/s",
            shaded(speed),
            ["The drive gives it; all curves coincide at this scale.", "The same in the fifth cycle."],
        )?,
        pair(
            &format!("{stem}-shaft-speed-difference"),
            "Fig. 16 Difference from a shaft without clearance",
            "difference of angular velocity, rad/s",
            shaded(difference),
            ["The swinging journal moves the crank's pivot.", "What is left of the swing when settled."],
        )?,
        pair(
            &format!("{stem}-joint-acceleration"),
            "Angular acceleration of the shaft, babbitt",
            "angular acceleration, rad/s2",
            shaded([rest, last]),
            ["Joint acceleration: the base of claim 11.", "The same in the fifth cycle."],
        )?,
    ];
    Ok(PaperFigure {
        heading: format!("Fig. 16, {stem} series: motion of the shaft"),
        text:
            "The sign changes of the acceleration are the reversals of claim 1. The load's ramp at the start \
               is shaded, not cut off."
                .into(),
        pictures: pictures.into_iter().flatten().collect(),
    })
}

/// Angular velocity of the crank with the journal centred, rad/s.
fn ideal_speed(bench: &TransmissionBench, time_s: f64) -> f64 {
    let lever = bench.geometry.drive_lever_radius_m;
    let motion = bench.drive_profile().at(time_s);
    let sin = motion.value / lever;
    motion.rate / (lever * (1.0 - sin * sin).sqrt())
}

/// Figs. 17 to 20: forces and friction torque of a bearing.
fn forces(both: &Both, number: u32) -> Result<PaperFigure, CliError> {
    let (stem, bearing) = (both.stem(), both.bearing.name());
    let sides = [&both.from_rest, &both.settled];
    let of = |read: Reading| sides.map(|lines| lines.iter().map(|l| l.curve(read)).collect::<Vec<_>>());
    let mut pictures = Vec::new();
    for (letter, file, what, axis, read) in PANELS {
        let [from_rest, settled] = of(read);
        let title = format!("Fig. {number} ({letter}) {what}, {bearing}");
        let captions = match letter {
            "d" => ["Negative while the shaft turns forward.", "The same in the fifth cycle."],
            "a" => ["One cycle from rest, as in the paper.", "The fifth cycle, analytic law."],
            _ => ["Component of the bearing's force on the journal.", "The same in the fifth cycle."],
        };
        let curves = [with_start(from_rest, &both.from_rest), settled];
        pictures.extend(pair(&format!("{stem}-{bearing}-{file}"), &title, axis, curves, captions)?);
    }
    let [from_rest, settled] = of(|s| s.forces.normal_n);
    let zoom = [zoomed(from_rest, &both.from_rest), zoomed(settled, &both.settled)];
    pictures.extend(pair(
        &format!("{stem}-{bearing}-zoom"),
        &format!("Fig. {number} (a) at the reversal, {bearing}"),
        "normal force, N",
        zoom,
        [".3 to .6 of the period: the swing after the journal has crossed over.", "The same when settled."],
    )?);
    pictures.extend(differences(both, number)?);
    Ok(PaperFigure {
        heading: format!("Fig. {number}: {bearing}, {stem} series"),
        text: sentence(both),
        pictures,
    })
}

/// Differences of curves that coincide over a part of the cycle.
fn differences(both: &Both, number: u32) -> Result<[Picture; 2], CliError> {
    let (stem, bearing) = (both.stem(), both.bearing.name());
    let sides = [&both.from_rest, &both.settled];
    let name = format!("{stem}-{bearing}-difference");
    match both.series {
        Series::Clearance => {
            let curves = sides.map(|lines| {
                let Some((smallest, others)) = lines.split_last() else { return Vec::new() };
                let less = |line: &Line| {
                    let pairs = line.samples.iter().zip(smallest.samples);
                    let points =
                        pairs.map(|(s, t)| (s.time_s - line.start_s, s.forces.normal_n - t.forces.normal_n));
                    Curve::through(line.label.clone(), points.collect())
                };
                others.iter().map(less).collect()
            });
            let smallest = both.from_rest.last().map(|l| l.label.clone()).unwrap_or_default();
            let title = format!("Fig. {number} (a) less that of {smallest}, {bearing}");
            let captions =
                ["The part that the clearance adds; at 0 the curves coincide.", "The same when settled."];
            pair(&name, &title, "difference of normal force, N", curves, captions)
        }
        Series::Load => {
            // The load on both cranks has this share of it in the bearing.
            let without_load = |line: &Line| {
                let levers = &line.bench.geometry;
                let share = 1.0 - levers.load_lever_radius_m / levers.drive_lever_radius_m;
                let part_n = share * line.bench.load.force_n;
                let ramp_s = line.bench.load.ramp_s;
                let mut curve = line.curve(|s| s.force_y_n + part_n);
                curve.points.retain(|(time_s, _)| time_s + line.start_s >= ramp_s);
                curve
            };
            let curves = sides.map(|lines| lines.iter().map(without_load).collect::<Vec<_>>());
            let title = format!("Fig. {number} (b) without the static part of the load, {bearing}");
            let captions =
                ["Where the curves coincide, the load only shifts the force.", "The same when settled."];
            pair(&name, &title, "force along Y less static part, N", curves, captions)
        }
    }
}

/// Largest normal force after the load's ramp, N.
fn peak_n(line: &Line) -> f64 {
    let counted = line.samples.iter().filter(|s| s.time_s >= line.bench.load.ramp_s);
    counted.map(|s| s.forces.normal_n).fold(0.0, f64::max)
}

/// Sentence with the peaks of both operations.
fn sentence(both: &Both) -> String {
    let peaks = |lines: &[Line]| {
        let each = lines.iter().map(|line| format!("{} {:.0} N", line.label, peak_n(line)));
        each.collect::<Vec<_>>().join(", ")
    };
    format!(
        "Peak normal force from rest: {}. In the fifth cycle: {}. Left: one cycle from rest; right: settled, \
         with the analytic law.",
        peaks(&both.from_rest),
        peaks(&both.settled)
    )
}
