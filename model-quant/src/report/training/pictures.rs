//! Pictures of the training report.

use super::ReportError;
use super::facts::BearingFacts;
use crate::evaluate::errors::FRICTION_RADIUS_M;
use crate::evaluate::verdict::Verdict;
use crate::report::torque::Curve;
use crate::train::history::{Epoch, History};
use report::figure::{Chart, Drawing, Series, Style, lines_log_log, lines_log_x, lines_log_y};
use report::heat::{self, Heat, Scale};

pub(super) const HALF: (u32, u32) = (512, 340);
const TABLE: (u32, u32) = (512, 280);
/// Smallest force in N in a picture with logarithmic axes.
const MIN_PLOTTED_N: f64 = 1.0;

/// A picture: file name without extension, caption, SVG.
#[derive(Clone, Debug)]
pub(crate) struct Picture {
    /// File name without extension.
    pub name: String,
    /// Caption.
    pub caption: String,
    /// Content.
    pub drawing: Drawing,
}

type Draw = fn(&Chart, &[Series]) -> Result<Drawing, String>;

pub(super) fn picture(
    draw: Draw,
    name: String,
    chart: &Chart,
    series: &[Series],
    caption: &str,
) -> Result<Picture, ReportError> {
    let drawing = draw(chart, series).map_err(ReportError::Picture)?;
    Ok(Picture { name, caption: caption.to_owned(), drawing })
}

/// Fig. 10: MSE and MAE over the epochs for training and validation, one picture for each network
/// and error.
///
/// # Errors
///
/// The drawing library fails.
pub(crate) fn epochs(history: &History) -> Result<Vec<Picture>, ReportError> {
    let bearing = &history.bearing;
    let mut pictures = Vec::new();
    for network in ["collision", "friction"] {
        let curve = |name: &str, read: fn(&Epoch) -> f64| {
            Series::new(
                name,
                history.epochs_of(network).map(|e| e.epoch as f64),
                history.epochs_of(network).map(read),
            )
        };
        let grid = history.epochs_of(network).find(|epoch| epoch.on_grid).map(|epoch| epoch.epoch);
        let caption = grid.map_or_else(String::new, |first| {
            format!("From epoch {first} on the weights move to the 8-bit grid.")
        });
        let errors: [(&str, &str, [Series; 2]); 2] = [
            ("mse", "MSE", [curve("training", |e| e.loss), curve("validation", |e| e.validation_loss)]),
            ("mae", "MAE", [curve("training", |e| e.mae), curve("validation", |e| e.validation_mae)]),
        ];
        for (file, what, series) in errors {
            let letter = if bearing == "babbitt" { "a" } else { "b" };
            let title = format!("Fig. 10 ({letter}) {what}, {bearing} {network}");
            let y = if file == "mse" { "MSE over the target's mean square" } else { "MAE over its rms" };
            let chart = Chart { title: &title, x: "epoch", y, size: HALF };
            pictures.push(picture(
                lines_log_y,
                format!("epochs-{bearing}-{network}-{file}"),
                &chart,
                &series,
                &caption,
            )?);
        }
    }
    Ok(pictures)
}

/// Forces of the image over those of the law, one point for each test row.
///
/// # Errors
///
/// The drawing library fails.
pub(crate) fn predictions(facts: &BearingFacts) -> Result<Vec<Picture>, ReportError> {
    let bearing = facts.bearing;
    let one = |which: usize, what: &str, unit: &str, factor: f64| {
        let points: Vec<(f64, f64)> = (facts.plotted.iter())
            .map(|[law, image]| [law, image].map(|f| f.get(which).map_or(0.0, |f| factor * f.abs())))
            .filter(|[law, _]| *law >= factor * MIN_PLOTTED_N)
            .map(|[law, image]| (law, image))
            .collect();
        let ends = || points.iter().map(|p| p.0);
        let (low, high) = (ends().fold(f64::INFINITY, f64::min), ends().fold(0.0, f64::max));
        let series = [
            Series::through("test rows", points.clone()).styled(Style::Points),
            Series::through("equal", vec![(low, low), (high, high)]),
        ];
        let title = format!("{what}, {bearing}");
        let (x, y) = (format!("law, {unit}"), format!("image, {unit}"));
        let chart = Chart { title: &title, x: &x, y: &y, size: HALF };
        let name = format!("prediction-{bearing}-{}", if which == 0 { "collision" } else { "friction" });
        picture(lines_log_log, name, &chart, &series, "Test rows, each with its history.")
    };
    Ok(vec![one(0, "Normal force", "N", 1.0)?, one(1, "Friction torque", "N m", FRICTION_RADIUS_M)?])
}

/// Figs. 12 and 13: torque over load and speed.
///
/// # Errors
///
/// The drawing library fails.
pub(crate) fn torque(facts: &BearingFacts) -> Result<Vec<Picture>, ReportError> {
    let bearing = facts.bearing;
    let degrees = |speed: f64| (speed / FRICTION_RADIUS_M).to_degrees();
    let mut series = Vec::new();
    for Curve { load_n, points } in facts.torque.iter().rev() {
        let points = points.iter().map(|&(speed, network, _)| (degrees(speed), network)).collect();
        series.push(Series::through(format!("{} kN", load_n * 1e-3), points));
    }
    let law = facts.torque.iter().flat_map(|c| c.points.iter().step_by(8));
    let law = law.map(|&(speed, _, law)| (degrees(speed), law)).collect();
    series.push(Series::through("law", law).styled(Style::Points));
    let title = format!("Torque over speed by load, {bearing}");
    let chart = Chart { title: &title, x: "relative angular speed, deg/s", y: "N m", size: HALF };
    let caption = "Fig. 13: lines are the quantised networks, points the law that they were trained on.";
    let curves = picture(lines_log_x, format!("torque-{bearing}-speed"), &chart, &series, caption)?;
    let map = &facts.torque_map;
    let values: Vec<Vec<Option<f64>>> =
        map.iter().rev().map(|c| c.points.iter().map(|p| Some(p.1)).collect()).collect();
    let columns = map
        .first()
        .map_or_else(Vec::new, |c| c.points.iter().map(|p| format!("{:.1}", degrees(p.0))).collect());
    let title = format!("Torque in N m over load and speed, {bearing}");
    let largest = values.iter().flatten().flatten().fold(0.0_f64, |m, v| m.max(*v));
    let heat = Heat {
        title: &title,
        x: "relative angular speed, deg/s",
        y: "load, kN",
        columns,
        rows: map.iter().rev().map(|c| format!("{}", c.load_n * 1e-3)).collect(),
        values,
        scale: Scale::Limit(largest),
        decimals: 1,
        size: TABLE,
    };
    let drawing = heat::draw(&heat).map_err(ReportError::Picture)?;
    let caption = "Fig. 12: the same as a map, from the quantised networks; darker is larger.".to_owned();
    Ok(vec![curves, Picture { name: format!("torque-{bearing}-map"), caption, drawing }])
}

/// Errors by force: float networks and image against the law, image against float networks.
///
/// # Errors
///
/// The drawing library fails.
pub(crate) fn bands(bearing: &str, verdicts: &[Verdict]) -> Result<Vec<Picture>, ReportError> {
    let one = |verdict: &Verdict| {
        let curve = |name: &str, read: fn(&crate::evaluate::verdict::Band) -> f64| {
            let counted = verdict.bands.iter().filter(|band| band.rows > 0);
            Series::through(name, counted.map(|band| (band.up_to_n, read(band))).collect())
                .styled(Style::Both)
        };
        let series = [
            curve("image, law", |b| b.mae_n),
            curve("float networks, law", |b| b.mae_float_n),
            curve("image, float networks", |b| b.mae_quantisation_n),
        ];
        let title = format!("Mean absolute difference by force, {bearing} {}", verdict.network);
        let chart = Chart { title: &title, x: "normal force up to, N", y: "N", size: HALF };
        let caption = "The third line is the quantisation error.";
        picture(lines_log_log, format!("bands-{bearing}-{}", verdict.network), &chart, &series, caption)
    };
    verdicts.iter().map(one).collect()
}
