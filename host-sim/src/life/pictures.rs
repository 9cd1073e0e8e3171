//! Pictures of a life: predicted and tracked clearance, worn profiles, figures of the duty cycle.

use super::{LifeResult, interval_m};
use crate::cli::error::CliError;
use crate::cli::output::{Files, Picture};
use bench::life::foundation::cell_angle_rad;
use bench::simulate::life::{Life, LifePoint};
use report::figure::{Chart, Series, Style, lines, map};

const WIDE: (u32, u32) = (1040, 420);
const HALF: (u32, u32) = (512, 340);
const SQUARE: (u32, u32) = (512, 540);

/// The pictures by section.
pub(crate) struct Pictures {
    pub(crate) clearance: Vec<Picture>,
    pub(crate) profiles: Vec<Picture>,
    pub(crate) duty: Vec<Picture>,
}

impl Pictures {
    /// Adds all as files of their own.
    pub(crate) fn add_to(&self, files: &mut Files) -> Result<(), CliError> {
        [&self.clearance, &self.profiles, &self.duty]
            .into_iter()
            .try_for_each(|pictures| files.add_pictures(pictures))
    }
}

/// Draws everything.
pub(crate) fn draw(result: &LifeResult) -> Result<Pictures, CliError> {
    Ok(Pictures {
        clearance: vec![clearance(result)?],
        profiles: vec![unrolled(result)?, polar(result)?],
        duty: duty(&result.lives[1])?,
    })
}

/// Predicted clearance with its interval, its limit, and the tracked clearance with two deviations.
fn clearance(result: &LifeResult) -> Result<Picture, CliError> {
    let life = &result.lives[1];
    let outcome = &result.outcome;
    let um = |cycle: f64, value_m: f64| (cycle, value_m * 1e6);
    let cycles: Vec<f64> = life.points.iter().map(|p| p.cycle).filter(|c| *c <= outcome.cycles).collect();
    let limit_m = outcome.limit_clearance_m;
    let end = |c: f64, i: usize| um(c, interval_m(&result.lives, limit_m, c)[i]);
    let mut interval: Vec<_> = cycles.iter().map(|c| end(*c, 1)).collect();
    interval.extend(cycles.iter().rev().map(|c| end(*c, 0)));
    let found = |t: &super::Tracked| Some((t.cycle, t.clearance_m?, t.clearance_sd_m?));
    let tracked: Vec<(f64, f64, f64)> = outcome.tracked.iter().filter_map(found).collect();
    let edge = |sign: f64| move |&(cycle, found_m, sd_m): &_| um(cycle, found_m + sign * 2.0 * sd_m);
    let mut band: Vec<_> = tracked.iter().map(edge(1.0)).collect();
    band.extend(tracked.iter().rev().map(edge(-1.0)));
    let series = [
        Series::through("interval of the wear rate", interval).styled(Style::Area),
        Series::through("tracked, two deviations", band).styled(Style::Area),
        Series::through("predicted", cycles.iter().map(|c| um(*c, life.clearance_m(*c))).collect()),
        Series::through("tracked", tracked.iter().map(|t| um(t.0, t.1)).collect()).styled(Style::Points),
        Series::through("limit", vec![um(0.0, limit_m), um(outcome.cycles, limit_m)]),
    ];
    let chart = Chart { title: "Radial clearance", x: "cycle", y: "radial clearance, um", size: WIDE };
    let caption = "Predicted clearance with the interval of the wear rate, and the clearance that the \
                   controller tracks with two of its reported deviations.";
    Picture::draw(lines, "clearance", &chart, &series, caption)
}

/// Wear depth over the angle at some points of the life.
fn unrolled(result: &LifeResult) -> Result<Picture, CliError> {
    let life = &result.lives[1];
    let depths = |index: usize| {
        let depths = &life.profiles[index].bearing_m;
        let point = |(cell, depth): (usize, &f64)| (cell_angle_rad(cell).to_degrees(), depth * 1e6);
        let name = format!("{:.2e} cycles", life.points[index].cycle);
        Series::through(name, depths.iter().enumerate().map(point).collect())
    };
    let series: Vec<Series> = result.shown_points().into_iter().map(depths).collect();
    let (x, y) = ("angle from +Y towards +Z, degrees", "wear depth, um");
    let chart = Chart { title: "Profile of the bearing", x, y, size: HALF };
    Picture::draw(lines, "profile", &chart, &series, "Depth of the bearing; 270 degrees is its bottom.")
}

/// The worn bore at the end around its circle, with the depth enlarged.
fn polar(result: &LifeResult) -> Result<Picture, CliError> {
    let life = &result.lives[1];
    let end_m = life.points.last().map_or(0.0, |point| point.largest_depth_m);
    // The largest depth is drawn as a third of the radius.
    let around = |index: usize| {
        let radius = |depth: f64| 1.0 + depth / (3.0 * end_m.max(f64::MIN_POSITIVE));
        let depths = life.profiles[index].bearing_m.iter().enumerate();
        let place = |(cell, depth): (usize, &f64)| {
            let (sine, cosine) = cell_angle_rad(cell).sin_cos();
            (radius(*depth) * cosine, radius(*depth) * sine)
        };
        let name = format!("{:.2e} cycles", life.points[index].cycle);
        let mut points: Vec<_> = depths.map(place).collect();
        points.extend(points.first().copied());
        Series::through(name, points)
    };
    let series: Vec<Series> = result.shown_points().into_iter().map(around).collect();
    let chart = Chart { title: "Worn bore", x: "y over the radius", y: "z over the radius", size: SQUARE };
    let caption = format!("Depth enlarged: {:.1} um are a third of the radius.", end_m * 1e6);
    Picture::draw(map, "bore", &chart, &series, &caption)
}

/// Figures of the duty cycle over the life.
fn duty(life: &Life) -> Result<Vec<Picture>, CliError> {
    let picture = |file: &str, title: &str, y: &str, read: fn(&LifePoint) -> f64, caption: &str| {
        let series = Series::through(title, life.points.iter().map(|p| (p.cycle, read(p))).collect());
        let chart = Chart { title, x: "cycle", y, size: HALF };
        Picture::draw(lines, file, &chart, &[series], caption)
    };
    Ok(vec![
        picture("peak-force", "Peak contact force", "N", |p| p.peak_force_n, "Largest of a duty cycle.")?,
        picture(
            "friction-torque",
            "Peak friction torque",
            "N m",
            |p| p.friction_torque_nm,
            "Without a sign.",
        )?,
        picture("heat", "Friction heat", "J", |p| p.heat_j, "Of one cycle.")?,
        picture("volume", "Worn volume", "cm3", |p| p.wear_volume_m3 * 1e6, "Bearing and journal.")?,
    ])
}
