//! Pictures of the rig's networks: torque of test groups over time and over sliding speed (the
//! paper's Fig. 11).

use super::ReportError;
use super::pictures::{HALF, Picture, picture};
use super::rig::{RigFacts, label};
use crate::evaluate::rig::TestGroup;
use report::figure::{Chart, Series, Style, lines};

/// Number of test groups that are drawn.
const DRAWN_GROUPS: usize = 3;
/// Minimum load in N of a drawn group: without load there is hardly any torque.
const MIN_LOAD_N: f64 = 1e3;
/// Number of points of each drawn curve.
const POINTS: usize = 1100;
const TRUTH_POINTS: usize = 60;
/// Distance beyond the range of the noise-free torque, relative to that range, within which
/// measured samples are drawn.
const BEYOND: f64 = 0.1;

/// Selects at most `count` evenly spaced points.
fn thinned(points: impl ExactSizeIterator<Item = (f64, f64)>, count: usize) -> Vec<(f64, f64)> {
    let step = points.len().div_ceil(count).max(1);
    points.step_by(step).collect()
}

/// Measured, noise-free and predicted torque of some test groups, over time and over speed.
///
/// # Errors
///
/// The drawing library fails.
pub(crate) fn groups(facts: &RigFacts) -> Result<Vec<Picture>, ReportError> {
    let loaded = |group: &&TestGroup| group.load_n.iter().any(|load| load.abs() >= MIN_LOAD_N);
    let mut pictures = Vec::new();
    for (number, group) in facts.groups.iter().filter(loaded).take(DRAWN_GROUPS).enumerate() {
        let TestGroup { time_s, sliding_speed_m_s, measured_nm, truth_nm, predicted_nm, .. } = group;
        let truth = truth_nm.as_deref().unwrap_or_default();
        let low = truth.iter().copied().fold(f64::INFINITY, f64::min);
        let high = truth.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let margin = BEYOND * (high - low);
        let seen = |torque: f64| torque >= low - margin && torque <= high + margin;
        let hidden = measured_nm.iter().filter(|torque| !seen(**torque)).count();
        let caption = format!("{hidden} of {} measured samples lie outside the picture.", measured_nm.len());
        let speed_mm_s: Vec<f64> = sliding_speed_m_s.iter().map(|speed| speed * 1e3).collect();
        for (file, axis, values) in
            [("time", "time, s", time_s), ("speed", "sliding speed, mm/s", &speed_mm_s)]
        {
            let curve = |name: &str, torque: &[f64], count: usize| {
                let points = values.iter().copied().zip(torque.iter().copied());
                Series::through(name, thinned(points, count))
            };
            let mut measured = curve("measured", measured_nm, POINTS).styled(Style::Wide);
            measured.points.retain(|point| seen(point.1));
            let series = [
                measured,
                curve("truth without noise", truth, TRUTH_POINTS).styled(Style::Points),
                curve("prediction", predicted_nm, POINTS),
            ];
            let title = format!("Friction torque, {}, {}", facts.bearing, label(group));
            let chart = Chart { title: &title, x: axis, y: "N m", size: HALF };
            let name = format!("rig-{}-{}-{file}", facts.bearing, number + 1);
            pictures.push(picture(lines, name, &chart, &series, &caption)?);
        }
    }
    Ok(pictures)
}
