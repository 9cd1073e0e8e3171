//! Charts as SVG text, small enough for inclusion in a page. The legend has a separate strip above
//! the plot, so that it never covers a curve.

use crate::axis::Axis;
use crate::chart::values;
pub use crate::chart::{Chart, Series, Style};
use crate::plot::{Plot, Scales};
use plotters::prelude::*;

/// Colours that most readers can distinguish, in the order of the series (Okabe and Ito).
pub const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
];

/// Picture as SVG text, and its points if a page can show them.
#[derive(Clone, Debug)]
pub struct Drawing {
    /// Picture, complete as a separate file.
    pub svg: String,
    pub(crate) plot: Option<Plot>,
}

impl From<String> for Drawing {
    /// Takes a picture that a page shows unchanged.
    fn from(svg: String) -> Self {
        Self { svg, plot: None }
    }
}

/// Maximum number of points drawn of a series in a picture: more would only enlarge it.
const MAX_POINTS: usize = 1600;
/// Height in pixels of a row of the legend.
const LEGEND_HEIGHT: u32 = 20;
/// Generous widths in pixels of a legend's line and of a character of its text.
const LEGEND_LINE: i32 = 20;
const CHARACTER: f64 = 7.2;

/// Colour of a [`Style::Shade`].
const GREY: RGBColor = RGBColor(150, 160, 170);

/// Draws a chart with linear axes. The error describes a failure to draw.
pub fn lines(chart: &Chart, series: &[Series]) -> Result<Drawing, String> {
    scaled(chart, series, Scales::default())
}

/// Draws a chart with a logarithmic horizontal axis; points with x at or below 0 are omitted.
pub fn lines_log_x(chart: &Chart, series: &[Series]) -> Result<Drawing, String> {
    scaled(chart, series, Scales { log_x: true, ..Scales::default() })
}

/// Draws a chart with a logarithmic vertical axis; points with y at or below 0 are omitted.
pub fn lines_log_y(chart: &Chart, series: &[Series]) -> Result<Drawing, String> {
    scaled(chart, series, Scales { log_y: true, ..Scales::default() })
}

/// Draws a chart with two logarithmic axes; points at or below 0 are omitted.
pub fn lines_log_log(chart: &Chart, series: &[Series]) -> Result<Drawing, String> {
    scaled(chart, series, Scales { log_x: true, log_y: true, equal: false })
}

fn scaled(chart: &Chart, series: &[Series], scales: Scales) -> Result<Drawing, String> {
    let axis = |is_log: bool, read: fn((f64, f64)) -> f64| {
        let all = values(series).map(read);
        if is_log { Axis::logarithmic(all) } else { Axis::linear(all) }
    };
    let svg = draw(chart, series, &axis(scales.log_x, |p| p.0), &axis(scales.log_y, |p| p.1), true)?;
    Ok(Drawing { svg, plot: Plot::new(chart, series, scales) })
}

/// Draws curves with equal scales on both axes, such as an orbit; x and y have the same unit.
pub fn map(chart: &Chart, series: &[Series]) -> Result<Drawing, String> {
    let sizes = values(series).flat_map(|p| [p.0.abs(), p.1.abs()]).filter(|size| size.is_finite());
    let max = sizes.fold(0.0, f64::max);
    let half = if max > 0.0 { 1.02 * max } else { 1.0 };
    let axis = Axis::linear([-half, half].into_iter());
    let svg = draw(chart, series, &axis, &axis, false)?;
    Ok(Drawing { svg, plot: Plot::new(chart, series, Scales { equal: true, ..Scales::default() }) })
}

/// Returns the position of every legend entry, row by row, and the number of rows.
fn legend_places(series: &[Series], width: u32) -> (Vec<(i32, u32)>, u32) {
    if series.len() < 2 {
        return (Vec::new(), 0);
    }
    let (mut x, mut row) = (74_i32, 0);
    let mut places = Vec::with_capacity(series.len());
    for s in series {
        let needed = LEGEND_LINE + 24 + (CHARACTER * s.name.chars().count() as f64) as i32;
        if x + needed > width as i32 && x > 74 {
            (x, row) = (74, row + 1);
        }
        places.push((x, row));
        x += needed;
    }
    (places, row + 1)
}

fn draw(chart: &Chart, series: &[Series], x: &Axis, y: &Axis, thin: bool) -> Result<String, String> {
    let mut svg = String::new();
    let failed = |e: &dyn std::fmt::Display| format!("chart `{}`: {e}", chart.title);
    {
        let area = SVGBackend::with_string(&mut svg, chart.size).into_drawing_area();
        area.fill(&WHITE).map_err(|e| failed(&e))?;
        let area = area.titled(chart.title, ("sans-serif", 17)).map_err(|e| failed(&e))?;
        let (places, rows) = legend_places(series, chart.size.0);
        let (legend, plot) = area.split_vertically(LEGEND_HEIGHT * rows);
        let mut context = ChartBuilder::on(&plot)
            .margin(8)
            .margin_right(18)
            .x_label_area_size(38)
            .y_label_area_size(66)
            .build_cartesian_2d(x.clone(), y.clone())
            .map_err(|e| failed(&e))?;
        context
            .configure_mesh()
            .x_desc(chart.x)
            .y_desc(chart.y)
            .x_labels(12)
            .y_labels(10)
            .light_line_style(TRANSPARENT)
            .bold_line_style(BLACK.mix(0.12))
            .draw()
            .map_err(|e| failed(&e))?;
        let own = |s: &Series, colour| if s.style == Style::Shade { &GREY } else { colour };
        let coloured = || series.iter().zip(COLOURS.iter().cycle()).map(|(s, colour)| (s, own(s, colour)));
        let is_area = |s: &Series| matches!(s.style, Style::Area | Style::Shade);
        let (areas, others): (Vec<_>, Vec<_>) = coloured().partition(|(s, _)| is_area(s));
        for (s, colour) in areas.into_iter().chain(others) {
            let points = if thin { s.thinned(MAX_POINTS) } else { s.points.clone() };
            let points: Vec<(f64, f64)> =
                points.into_iter().filter_map(|p| Some((x.place(p.0)?, y.place(p.1)?))).collect();
            if is_area(s) {
                let area = Polygon::new(points, colour.mix(0.3).filled());
                context.draw_series([area]).map_err(|e| failed(&e))?;
                continue;
            }
            if s.style != Style::Points {
                let stroke = match s.style {
                    Style::Wide => colour.mix(0.4).stroke_width(4),
                    _ => colour.stroke_width(1),
                };
                let line = LineSeries::new(points.iter().copied(), stroke);
                context.draw_series(line).map_err(|e| failed(&e))?;
            }
            if matches!(s.style, Style::Points | Style::Both) {
                let dots = points.iter().map(|p| Circle::new(*p, 3, colour.filled()));
                context.draw_series(dots).map_err(|e| failed(&e))?;
            }
        }
        for ((s, colour), (from, row)) in coloured().zip(places) {
            let middle = (LEGEND_HEIGHT * row + LEGEND_HEIGHT / 2) as i32;
            let line =
                PathElement::new([(from, middle), (from + LEGEND_LINE, middle)], colour.stroke_width(3));
            legend.draw(&line).map_err(|e| failed(&e))?;
            let text = Text::new(s.name.clone(), (from + LEGEND_LINE + 6, middle - 6), ("sans-serif", 13));
            legend.draw(&text).map_err(|e| failed(&e))?;
        }
        area.present().map_err(|e| failed(&e))?;
    }
    Ok(svg)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_area_is_one_polygon_under_the_lines() {
        let outline = vec![(0.0, 1.0), (1.0, 2.0), (1.0, -2.0), (0.0, -1.0)];
        let series = [
            Series::new("line", [0.0, 1.0], [0.0, 0.5]),
            Series::through("band", outline).styled(Style::Area),
        ];
        let chart = Chart { title: "t", x: "x", y: "y", size: (400, 300) };
        let svg = lines(&chart, &series).unwrap().svg;
        let (polygon, line) = (svg.find("<polygon").unwrap(), svg.rfind("<polyline").unwrap());
        assert_eq!(svg.matches("<polygon").count(), 1);
        assert!(polygon < line);
    }

    #[test]
    fn a_shade_is_grey_under_the_lines_and_as_high_as_they_are() {
        let line = Series::new("line", [0.0, 1.0, 2.0], [-3.0, 5.0, f64::NAN]);
        let shade = Series::shade("start", (0.0, 0.5), core::slice::from_ref(&line));
        assert_eq!(shade.points, [(0.0, -3.0), (0.0, 5.0), (0.5, 5.0), (0.5, -3.0)]);
        assert!(Series::shade("start", (0.0, 0.5), &[]).points.is_empty());
        let chart = Chart { title: "t", x: "x", y: "y", size: (400, 300) };
        let svg = lines(&chart, &[line, shade]).unwrap().svg;
        let grey = svg.find("<polygon").filter(|at| svg[*at..].to_lowercase().contains("#96a0aa"));
        assert!(grey.unwrap() < svg.rfind("<polyline").unwrap());
    }

    #[test]
    fn a_thinned_area_keeps_the_order_of_its_outline() {
        let x = (0..10_000).map(f64::from).chain((0..10_000).rev().map(f64::from));
        let area = Series::through("band", x.map(|x| (x, x)).collect()).styled(Style::Area);
        let thinned = area.thinned(MAX_POINTS);
        let highest =
            thinned.iter().position(|p| p.0 == thinned.iter().fold(0.0, |a, p| p.0.max(a))).unwrap();
        assert!(thinned.len() <= MAX_POINTS && thinned.len() > 1000);
        assert!(thinned[..highest].is_sorted() && thinned[highest..].is_sorted_by(|a, b| a >= b));
    }

    #[test]
    fn thinning_keeps_the_peak() {
        let mut y = vec![0.0; 100_000];
        y[77_777] = 5.0;
        let series = Series::new("spike", (0..100_000).map(f64::from), y);
        let thinned = series.thinned(MAX_POINTS);
        assert!(thinned.len() <= MAX_POINTS + 2);
        assert!(thinned.iter().any(|p| p.1 == 5.0));
    }

    #[test]
    fn values_that_are_not_numbers_hide_no_peak() {
        let mut y = vec![0.0; 100_000];
        (y[77_776], y[77_777], y[77_778]) = (f64::NAN, 5.0, f64::INFINITY);
        (y[10_000], y[10_001]) = (f64::NEG_INFINITY, -3.0);
        let thinned = Series::new("spike", (0..100_000).map(f64::from), y).thinned(MAX_POINTS);
        assert!(thinned.iter().any(|p| p.1 == 5.0) && thinned.iter().any(|p| p.1 == -3.0));
    }

    #[test]
    fn an_empty_chart_is_still_a_picture() {
        let chart = Chart { title: "empty", x: "x", y: "y", size: (300, 200) };
        for draw in [lines, lines_log_x, lines_log_y, lines_log_log, map] {
            assert!(draw(&chart, &[]).unwrap().svg.starts_with("<svg"));
        }
    }

    #[test]
    fn a_long_legend_takes_a_second_row_and_leaves_the_plot_alone() {
        let series: Vec<Series> =
            (0..6).map(|i| Series::new(format!("a long series name {i}"), [0.0, 1.0], [0.0, 1.0])).collect();
        let (places, rows) = legend_places(&series, 500);
        assert!(rows > 1 && places.iter().all(|(x, _)| *x < 500));
        let chart = Chart { title: "t", x: "x", y: "y", size: (500, 300) };
        assert!(lines(&chart, &series).unwrap().svg.contains("a long series name 5"));
    }
}
