//! Content of a chart: its titles and its series, before it is drawn.

/// Drawing style of a series.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    /// A line through the points.
    Line,
    /// A wide pale line, as background for another line.
    Wide,
    /// The points alone.
    Points,
    /// The points and a line through them.
    Both,
    /// The area within the points, pale and under everything else.
    Area,
    /// The same in grey, to mark a part of the horizontal axis. It takes no colour from the series,
    /// so it stands last.
    Shade,
}

/// One line of a chart.
#[derive(Clone, Debug)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// Points, ascending in x unless the chart is a map.
    pub points: Vec<(f64, f64)>,
    /// Drawing style.
    pub style: Style,
}

impl Series {
    /// Creates a line from two columns.
    pub fn new(
        name: impl Into<String>,
        x: impl IntoIterator<Item = f64>,
        y: impl IntoIterator<Item = f64>,
    ) -> Self {
        Self::through(name, x.into_iter().zip(y).collect())
    }

    /// Creates a line through points.
    pub fn through(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.into(), points, style: Style::Line }
    }

    /// Creates a grey area over a part of the horizontal axis, as high as some other series.
    pub fn shade(name: impl Into<String>, (from, to): (f64, f64), others: &[Self]) -> Self {
        let heights = || values(others).map(|p| p.1).filter(|y| y.is_finite());
        let (low, high) =
            (heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max));
        let outline =
            if low <= high { vec![(from, low), (from, high), (to, high), (to, low)] } else { Vec::new() };
        Self::through(name, outline).styled(Style::Shade)
    }

    /// Returns the series in another style.
    pub fn styled(self, style: Style) -> Self {
        Self { style, ..self }
    }

    /// Returns the lowest and the highest point of every section, so that no peak is lost. Points
    /// that are not finite are ignored.
    pub(crate) fn thinned(&self, most: usize) -> Vec<(f64, f64)> {
        if self.points.len() <= most || matches!(self.style, Style::Points | Style::Both) {
            return self.points.clone();
        }
        if matches!(self.style, Style::Area | Style::Shade) {
            // An outline runs forth and back, so the extremes of a section have no order.
            let every = self.points.len().div_ceil(most);
            return self.points.iter().copied().step_by(every).collect();
        }
        let stretch = self.points.len().div_ceil(most / 2);
        let mut out = Vec::with_capacity(most);
        for chunk in self.points.chunks(stretch) {
            let by_y = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
            let finite = || chunk.iter().filter(|(x, y)| x.is_finite() && y.is_finite());
            let (Some(low), Some(high)) = (finite().min_by(by_y), finite().max_by(by_y)) else {
                continue;
            };
            out.extend(if low.0 <= high.0 { [*low, *high] } else { [*high, *low] });
        }
        out
    }
}

/// Titles and size of a chart.
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

pub(crate) fn values(series: &[Series]) -> impl Iterator<Item = (f64, f64)> + Clone {
    series.iter().flat_map(|s| s.points.iter().copied())
}
