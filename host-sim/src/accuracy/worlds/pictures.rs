//! The pictures of `host-sim accuracy --worlds`: one drawn world over time, and the errors of all.

use super::cases::{self, OperatingPoint, RealWorld, Set};
use super::estimators::{Estimate, EstimatorKind};
use super::outcome::Outcome;
use super::recorded::Recorded;
use super::score::{Case, SECTIONS, START_S, reversals_s};
use crate::cli::error::CliError;
use crate::cli::output::{Files, Picture};
use crate::run::conditions::BEARINGS;
use ::worlds::Row;
use report::figure::{Chart, Series, Style, lines, lines_log_log, lines_log_y};

const WIDE: (u32, u32) = (1040, 340);
const HALF: (u32, u32) = (512, 340);
/// Half of the time that is shown around a reversal, s.
const AROUND_S: f64 = 0.02;
/// Clearance and load of the world that is shown over time.
const SHOWN: (f64, f64) = (0.5, 10.0);

/// The pictures by their width.
#[derive(Default)]
pub(super) struct Pictures {
    pub(super) wide: Vec<Picture>,
    pub(super) half: Vec<Picture>,
}

impl Pictures {
    /// Adds all as separate files.
    pub(super) fn add_to(&self, files: &mut Files) -> Result<(), CliError> {
        [&self.wide, &self.half].into_iter().try_for_each(|pictures| files.add_pictures(pictures))
    }
}

/// Draws everything.
pub(super) fn draw(outcome: &Outcome) -> Result<Pictures, CliError> {
    let is_shown = |case: &&Case| (case.point.clearance_mm, case.point.load_kn) == SHOWN;
    let Some(point) = outcome.cases.iter().find(is_shown).map(|case| case.point) else {
        return Ok(Pictures::default());
    };
    let shown = Shown::new(outcome, point)?;
    let mut pictures = shown.map_or_else(|| Ok(Pictures::default()), |shown| shown.pictures())?;
    pictures.wide.push(courses(outcome, point)?);
    pictures.half.push(every_world(outcome)?);
    Ok(pictures)
}

/// The drawn world with the median error of the estimate, over time.
struct Shown {
    title: String,
    rows: Vec<Row>,
    network: Vec<Estimate>,
    law: Vec<Estimate>,
}

/// Reads a value of an estimate.
type Read = fn(&Estimate) -> f64;

impl Shown {
    fn new(outcome: &Outcome, point: OperatingPoint) -> Result<Option<Self>, CliError> {
        let mut drawn: Vec<&Case> =
            drawn(outcome, EstimatorKind::Network).filter(|c| c.point == point).collect();
        drawn.sort_by(|a, b| a.rms_n.total_cmp(&b.rms_n));
        let Some(median) = drawn.get(drawn.len() / 2) else { return Ok(None) };
        let mut worlds = cases::worlds(&point, outcome.worlds, outcome.seed).into_iter();
        let Some(real): Option<RealWorld> = worlds.find(|real| real.name == median.world) else {
            return Ok(None);
        };
        let recorded = Recorded::new(&point, &real, outcome.seed);
        Ok(Some(Self {
            title: median.place(),
            network: recorded.estimates(&point, EstimatorKind::Network)?,
            law: recorded.estimates(&point, EstimatorKind::Law)?,
            rows: recorded.rows,
        }))
    }

    /// A value over time between two times.
    fn curve(&self, name: &str, (from, to): (f64, f64), value: impl Fn(usize, &Row) -> f64) -> Series {
        let rows = self.rows.iter().enumerate().filter(|(_, row)| (from..=to).contains(&row.time_s));
        Series::through(name, rows.map(|(i, row)| (row.time_s, value(i, row))).collect())
    }

    /// The area within a value plus and minus two standard deviations.
    fn band(&self, span: (f64, f64), value: impl Fn(usize, &Row) -> f64, which: usize) -> Series {
        let deviation = |i: usize| self.network[i].deviations[which];
        let edge =
            |sign: f64| self.curve("", span, |i, row| value(i, row) + 2.0 * sign * deviation(i)).points;
        let mut points = edge(1.0);
        points.extend(edge(-1.0).into_iter().rev());
        Series::through("band of 2 standard deviations", points).styled(Style::Area)
    }

    fn pictures(&self) -> Result<Pictures, CliError> {
        let (force, torque): (Read, Read) = (|e| e.force_n[0], |e| e.torque_nm);
        let run = (START_S, self.rows.last().map_or(START_S, |row| row.time_s));
        let middle = 0.5 * run.1;
        let nearest = |a: &f64, b: &f64| (a - middle).abs().total_cmp(&(b - middle).abs());
        let reversal = reversals_s(&self.rows).min_by(nearest).unwrap_or(middle);
        let near = (reversal - AROUND_S, reversal + AROUND_S);
        let title = format!("Contact force along Y, {}", self.title);
        let chart = Chart { title: &title, x: "time, s", y: "N", size: WIDE };
        let over = [
            self.curve("truth", run, |_, row| row.force_y_n).styled(Style::Wide),
            self.curve("estimate", run, |i, _| force(&self.network[i])),
            self.curve("with the law", run, |i, _| force(&self.law[i])),
        ];
        let enlarged = [
            self.curve("truth", near, |_, row| row.force_y_n).styled(Style::Wide),
            self.curve("estimate", near, |i, _| force(&self.network[i])),
            self.band(near, |i, _| force(&self.network[i]), 0),
        ];
        let error = [
            self.curve("error of the estimate", run, |i, row| force(&self.network[i]) - row.force_y_n),
            self.band(run, |_, _| 0.0, 0),
        ];
        let torques = [
            self.curve("truth", near, |_, row| row.friction_torque_nm).styled(Style::Wide),
            self.curve("estimate", near, |i, _| torque(&self.network[i])),
            self.band(near, |i, _| torque(&self.network[i]), 1),
        ];
        let half = Chart { title: "Contact force along Y around a reversal", size: HALF, ..chart };
        let titled_error = Chart { title: "Error of the estimate along Y in that world", ..chart };
        let torque_chart = Chart { title: "Friction torque around the same reversal", y: "N m", ..half };
        Ok(Pictures {
            wide: vec![
                Picture::draw(lines, "world-force", &chart, &over, "The drawn world with the median error.")?,
                Picture::draw(
                    lines,
                    "world-error",
                    &titled_error,
                    &error,
                    "The band is two reported deviations.",
                )?,
            ],
            half: vec![
                Picture::draw(
                    lines,
                    "world-force-reversal",
                    &half,
                    &enlarged,
                    "Sliding reverses in the middle.",
                )?,
                Picture::draw(
                    lines,
                    "world-torque-reversal",
                    &torque_chart,
                    &torques,
                    "Friction changes its sign within a few milliseconds.",
                )?,
            ],
        })
    }
}

fn drawn(outcome: &Outcome, estimator: EstimatorKind) -> impl Iterator<Item = &Case> {
    outcome.cases.iter().filter(move |case| case.set == Set::Drawn && case.estimator == estimator)
}

/// Median and largest error over the cycle of all drawn worlds of an operating point.
fn courses(outcome: &Outcome, point: OperatingPoint) -> Result<Picture, CliError> {
    let courses = |name: &str, estimator| {
        let of_point: Vec<&Case> = drawn(outcome, estimator).filter(|case| case.point == point).collect();
        let section_s = (point.described_world().period_s - START_S) / SECTIONS as f64;
        let at = |section: usize, largest: bool| {
            let share = |case: &&Case| case.course_n.get(section).map(|n| 100.0 * n / case.full_scale_n);
            let mut shares: Vec<f64> = of_point.iter().filter_map(share).collect();
            shares.sort_by(f64::total_cmp);
            let place = if largest { shares.len().checked_sub(1)? } else { shares.len() / 2 };
            Some((START_S + (section as f64 + 0.5) * section_s, *shares.get(place)?))
        };
        [("median", false), ("largest", true)].map(|(which, largest)| {
            let points = (0..SECTIONS).filter_map(|section| at(section, largest)).collect();
            Series::through(format!("{name}, {which}"), points)
        })
    };
    let series =
        [courses("with networks", EstimatorKind::Network), courses("with the law", EstimatorKind::Law)]
            .concat();
    let title = format!("Error of the force in all {} drawn worlds, {}", outcome.worlds, point.name());
    let chart = Chart { title: &title, x: "time, s", y: "rms, % of full scale", size: WIDE };
    let caption = "Rms of the force vector's error in sections of a hundredth of the cycle.";
    Picture::draw(lines_log_y, "worlds-course", &chart, &series, caption)
}

/// Error with the networks over the error with the law, a point for each drawn world.
fn every_world(outcome: &Outcome) -> Result<Picture, CliError> {
    let of_bearing = |bearing: bench::BearingMaterial| {
        let pairs = drawn(outcome, EstimatorKind::Law).zip(drawn(outcome, EstimatorKind::Network));
        let pairs = pairs.filter(|(law, _)| law.point.material() == bearing);
        let points = pairs.map(|(law, network)| (100.0 * law.force_share(), 100.0 * network.force_share()));
        Series::through(bearing.name(), points.collect()).styled(Style::Points)
    };
    let mut series = BEARINGS.map(of_bearing).to_vec();
    let ends = series.iter().flat_map(|s| &s.points).flat_map(|p| [p.0, p.1]).filter(|v| *v > 0.0);
    let (low, high) = ends.fold((f64::INFINITY, 0.0_f64), |(a, b), v| (a.min(v), b.max(v)));
    if low < high {
        series.push(Series::through("equal", vec![(low, low), (high, high)]));
    }
    let chart = Chart {
        title: "Rms error of every drawn world, % of full scale",
        x: "with the law, %",
        y: "with networks, %",
        size: HALF,
    };
    let caption = "A point for each world; below the line the networks are better.";
    Picture::draw(lines_log_log, "worlds-every", &chart, &series, caption)
}
