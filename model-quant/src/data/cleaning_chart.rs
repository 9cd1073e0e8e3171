//! The paper's Fig. 8 as SVG: a torque as logged and after cleaning. Three panels show the complete
//! log, the steepest place, and a place a quarter of the way through, where the pair slides.

use super::friction::Group;
use plotters::prelude::*;
use std::ops::Range;

/// Width and height in pixels.
const SIZE: (u32, u32) = (960, 960);
/// Length of an enlarged panel in s.
const PART_S: f64 = 2.0;
/// Colours of the raw and of the cleaned curve.
const COLOURS: [RGBColor; 2] = [RGBColor(150, 160, 170), RGBColor(213, 94, 0)];

/// Error of the drawing library, as text.
#[derive(Debug, thiserror::Error)]
#[error("picture: {0}")]
pub(crate) struct PictureError(String);

/// Draws the torque of a group.
pub(crate) fn comparison(group: &Group) -> Result<String, PictureError> {
    let mut text = String::new();
    draw(&mut text, group).map_err(|error| PictureError(error.to_string()))?;
    Ok(text)
}

fn draw<'a>(text: &'a mut String, group: &Group) -> Result<(), Box<dyn std::error::Error + 'a>> {
    let area = SVGBackend::with_string(text, SIZE).into_drawing_area();
    area.fill(&WHITE)?;
    let start_s = group.time_s.first().copied().unwrap_or_default();
    let end_s = group.time_s.last().copied().unwrap_or_default();
    // One panel shows the steepest place of the cleaned torque: smoothing distorts it most.
    let [.., clean] = &group.clean;
    let steps = clean.windows(2).enumerate().map(|(place, pair)| {
        let [a, b] = [pair.first(), pair.last()].map(|v| v.copied().unwrap_or_default());
        (place, (b - a).abs())
    });
    let steepest = steps.max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(place, _)| place);
    let middle_s = group.time_s.get(steepest).copied().unwrap_or_default();
    let part_s = (middle_s - 0.25 * PART_S).max(start_s);
    // By sample count: in a log with a gap, a quarter of the time may contain no sample.
    let quarter_s = group.time_s.get(group.time_s.len() / 4).copied().unwrap_or(start_s);
    let title = format!("Torque as logged and cleaned, {}", group.source);
    let parts = [
        (start_s, end_s, title.as_str()),
        (part_s, part_s + PART_S, "The steepest place, enlarged"),
        (quarter_s, quarter_s + PART_S, "A quarter of the way through, enlarged"),
    ];
    for (panel_area, (from_s, to_s, title)) in area.split_evenly((3, 1)).iter().zip(parts) {
        panel(panel_area, group, from_s..to_s.min(end_s), title)?;
    }
    area.present()?;
    Ok(())
}

fn panel<'a>(
    area: &DrawingArea<SVGBackend<'a>, plotters::coord::Shift>,
    group: &Group,
    time_s: Range<f64>,
    title: &str,
) -> Result<(), Box<dyn std::error::Error + 'a>> {
    let curve = |torque: &[f64]| -> Vec<(f64, f64)> {
        let points = group.time_s.iter().copied().zip(torque.iter().copied());
        points.filter(|(t, _)| time_s.contains(t)).collect()
    };
    let ([.., raw], [.., clean]) = (&group.raw, &group.clean);
    let curves = [("as logged", curve(raw)), ("outliers removed, Gaussian-weighted average", curve(clean))];
    let values = || curves.iter().flat_map(|(_, points)| points.iter().map(|p| p.1));
    let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
    // The axis needs finite ends and a length that its ticks can resolve.
    let (low, high) = if low <= high { (low, high) } else { (0.0, 0.0) };
    // Space for the legend above the curves.
    let margin = 0.05 * (high - low).max(1e-3 * high.abs().max(low.abs())).max(1e-9);
    let mut chart = ChartBuilder::on(area)
        .caption(title, ("sans-serif", 18))
        .margin(12)
        .x_label_area_size(36)
        .y_label_area_size(70)
        .build_cartesian_2d(time_s.clone(), low - margin..high + 6.0 * margin)?;
    chart
        .configure_mesh()
        .x_desc("time in s")
        .y_desc("friction torque in N m")
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .draw()?;
    for ((name, points), colour) in curves.into_iter().zip(COLOURS) {
        let style = colour.stroke_width(if colour == COLOURS[0] { 1 } else { 2 });
        chart
            .draw_series(LineSeries::new(points, style))?
            .label(name)
            .legend(move |(x, y)| PathElement::new(vec![(x, y), (x + 24, y)], style));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .legend_area_size(30)
        .background_style(TRANSPARENT)
        .border_style(TRANSPARENT)
        .draw()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::split::Split;
    use super::*;

    fn group(time_s: Vec<f64>, torque_nm: fn(f64) -> f64) -> Group {
        let columns = [0.0, 0.0].map(|value| vec![value; time_s.len()]);
        let torque: Vec<f64> = time_s.iter().map(|&time_s| torque_nm(time_s)).collect();
        let [load, speed] = columns;
        let raw = [load, speed, torque];
        Group { source: "log".into(), split: Split::Test, clean: raw.clone(), raw, time_s, outliers: 0 }
    }

    #[test]
    fn logs_with_gaps_and_constant_torques_are_drawn() {
        let even = |from: f64| (0..2048).map(move |i| from + 0.004 * f64::from(i));
        for gap_s in [0.0, 10.0, 1e9] {
            for place in [3, 600, 2000] {
                let time_s = even(0.0).zip(0..).map(|(t, i)| if i < place { t } else { t + gap_s }).collect();
                let drawn = comparison(&group(time_s, |t| (3.0 * t).sin())).unwrap();
                assert_eq!(drawn.matches("<svg").count(), 1, "{gap_s} s at {place}");
            }
        }
        let levels: [fn(f64) -> f64; 3] = [|_| 0.0, |_| 1e9, |_| -1e-12];
        for level in levels {
            assert!(comparison(&group(even(1.7e9).collect(), level)).is_ok());
        }
    }
}
