//! Charts as SVG text, small enough to stand inside a page.

use plotters::prelude::*;

/// Colours that stay apart for most readers, in the order of the series (Okabe and Ito).
pub const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
];

/// Points a series may keep: more would only make the page heavier.
const MOST_POINTS: usize = 1600;

/// One line of a chart.
#[derive(Clone, Debug)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// Points, ascending in x unless the chart is a map.
    pub points: Vec<(f64, f64)>,
}

impl Series {
    /// A series from two columns.
    pub fn new(
        name: impl Into<String>,
        x: impl IntoIterator<Item = f64>,
        y: impl IntoIterator<Item = f64>,
    ) -> Self {
        Self { name: name.into(), points: x.into_iter().zip(y).collect() }
    }

    /// The least and the greatest point of every stretch, so that no peak is lost.
    fn thinned(&self) -> Vec<(f64, f64)> {
        if self.points.len() <= MOST_POINTS {
            return self.points.clone();
        }
        let stretch = self.points.len().div_ceil(MOST_POINTS / 2);
        let mut out = Vec::with_capacity(MOST_POINTS);
        for chunk in self.points.chunks(stretch) {
            let by_y = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
            let (Some(low), Some(high)) = (chunk.iter().min_by(by_y), chunk.iter().max_by(by_y)) else {
                continue;
            };
            out.extend(if low.0 <= high.0 { [*low, *high] } else { [*high, *low] });
        }
        out
    }
}

/// What a chart is called and how large it is.
#[derive(Clone, Copy, Debug)]
pub struct Chart<'a> {
    /// Title.
    pub title: &'a str,
    /// Horizontal axis with unit.
    pub x: &'a str,
    /// Vertical axis with unit.
    pub y: &'a str,
    /// Width and height in pixels.
    pub size: (u32, u32),
}

fn span(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values
        .filter(|v| v.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
    if !(low.is_finite() && high.is_finite()) {
        return (0.0, 1.0);
    }
    let margin = if high > low { 0.04 * (high - low) } else { 0.5 * high.abs().max(1e-9) };
    (low - margin, high + margin)
}

/// A line chart. An error is a drawing failure, in words.
pub fn lines(chart: &Chart, series: &[Series]) -> Result<String, String> {
    let all = || series.iter().flat_map(|s| s.points.iter());
    let x = span(all().map(|p| p.0));
    let y = span(all().map(|p| p.1));
    draw(chart, series, x, y, true)
}

/// A map of curves with equal scales on both axes, such as an orbit; x and y in the same unit.
pub fn map(chart: &Chart, series: &[Series]) -> Result<String, String> {
    let most =
        series.iter().flat_map(|s| s.points.iter()).fold(0.0_f64, |m, p| m.max(p.0.abs()).max(p.1.abs()));
    let half = if most > 0.0 { 1.08 * most } else { 1.0 };
    draw(chart, series, (-half, half), (-half, half), false)
}

fn draw(
    chart: &Chart,
    series: &[Series],
    x: (f64, f64),
    y: (f64, f64),
    thin: bool,
) -> Result<String, String> {
    let mut svg = String::new();
    let failed = |e: &dyn std::fmt::Display| format!("chart `{}`: {e}", chart.title);
    {
        let area = SVGBackend::with_string(&mut svg, chart.size).into_drawing_area();
        area.fill(&WHITE).map_err(|e| failed(&e))?;
        let mut context = ChartBuilder::on(&area)
            .caption(chart.title, ("sans-serif", 17))
            .margin(10)
            .x_label_area_size(38)
            .y_label_area_size(74)
            .build_cartesian_2d(x.0..x.1, y.0..y.1)
            .map_err(|e| failed(&e))?;
        let (x_step, y_step) = (x.1 - x.0, y.1 - y.0);
        context
            .configure_mesh()
            .x_desc(chart.x)
            .y_desc(chart.y)
            .x_labels(9)
            .y_labels(7)
            .light_line_style(TRANSPARENT)
            .bold_line_style(BLACK.mix(0.12))
            .x_label_formatter(&move |v| label(*v, x_step))
            .y_label_formatter(&move |v| label(*v, y_step))
            .draw()
            .map_err(|e| failed(&e))?;
        for (s, colour) in series.iter().zip(COLOURS.iter().cycle()) {
            let points = if thin { s.thinned() } else { s.points.clone() };
            context
                .draw_series(LineSeries::new(points, colour.stroke_width(1)))
                .map_err(|e| failed(&e))?
                .label(s.name.clone())
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], colour.stroke_width(3)));
        }
        if series.len() > 1 {
            context
                .configure_series_labels()
                .position(SeriesLabelPosition::UpperRight)
                .background_style(WHITE.mix(0.85))
                .border_style(BLACK.mix(0.2))
                .draw()
                .map_err(|e| failed(&e))?;
        }
        area.present().map_err(|e| failed(&e))?;
    }
    Ok(svg)
}

/// As many decimals as the axis' span needs.
fn label(value: f64, span: f64) -> String {
    let digits = (1.0 - span.log10()).ceil().clamp(0.0, 9.0) as usize;
    if span < 1e-5 { format!("{value:.1e}") } else { format!("{value:.digits$}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_the_peak() {
        let mut y = vec![0.0; 100_000];
        y[77_777] = 5.0;
        let series = Series::new("spike", (0..100_000).map(f64::from), y);
        let thinned = series.thinned();
        assert!(thinned.len() <= MOST_POINTS + 2);
        assert!(thinned.iter().any(|p| p.1 == 5.0));
    }

    #[test]
    fn an_empty_chart_is_still_a_picture() {
        let chart = Chart { title: "empty", x: "x", y: "y", size: (300, 200) };
        assert!(lines(&chart, &[]).unwrap().starts_with("<svg"));
    }
}
