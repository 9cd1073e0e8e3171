//! Data of a page's charts, for the script that draws them so that they zoom and show values.
//!
//! A figure carries the description of its chart. Its columns stand at the end of the page in
//! base64 and are shared by all charts.

use crate::chart::{Chart, Series, Style};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::collections::HashMap;
use std::fmt::Write as _;

/// Drawing library uPlot 1.6.32, licensed under the MIT licence.
const LIBRARY: &str = include_str!("../vendor/uPlot.iife.min.js");
/// Its style.
pub(crate) const LIBRARY_STYLE: &str = include_str!("../vendor/uPlot.min.css");
/// Scripts that create the charts and play the sketches.
const SCRIPTS: [&str; 2] = [include_str!("plot.js"), include_str!("sketch.js")];
/// Notice in place of the library's own, which has an address of the web.
const NOTICE: &str = "/*! uPlot 1.6.32, (c) 2022 Leon Sorokin, MIT licence */\n";

/// Maximum number of points of a series in a page; of more, the extremes of sections remain.
const MAX_POINTS: usize = 200_000;

/// Scales of a chart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Scales {
    pub(crate) log_x: bool,
    pub(crate) log_y: bool,
    /// Both axes have the same scale.
    pub(crate) equal: bool,
}

/// Chart with all of its points.
#[derive(Clone, Debug)]
pub(crate) struct Plot {
    title: String,
    x: String,
    y: String,
    size: (u32, u32),
    scales: Scales,
    is_map: bool,
    series: Vec<Curve>,
}

/// Series of a chart by columns.
#[derive(Clone, Debug)]
struct Curve {
    name: String,
    style: &'static str,
    x: Vec<f64>,
    /// One column; of an area the highest and the lowest.
    y: Vec<Vec<f64>>,
}

impl Plot {
    /// Takes the points of a chart; `None` if nothing can be drawn, or if an area is no band.
    pub(crate) fn new(chart: &Chart, series: &[Series], scales: Scales) -> Option<Self> {
        let is_line = |s: &&Series| !matches!(s.style, Style::Area | Style::Shade);
        let is_ascending = |s: &Series| s.points.is_sorted_by(|a, b| a.0 <= b.0);
        let is_map = scales.equal || !series.iter().filter(is_line).all(is_ascending);
        let curves = series.iter().map(|s| Curve::new(s, scales, is_map)).collect::<Option<Vec<_>>>()?;
        let series: Vec<Curve> = curves.into_iter().filter(|curve| !curve.x.is_empty()).collect();
        let has_lines = series.iter().any(|curve| curve.style != "shade");
        let (title, x, y) = (chart.title.into(), chart.x.into(), chart.y.into());
        has_lines.then_some(Self { title, x, y, size: chart.size, scales, is_map, series })
    }
}

impl Curve {
    fn new(series: &Series, scales: Scales, is_map: bool) -> Option<Self> {
        let is_placed = |p: &(f64, f64)| p.0.is_finite() && (!scales.log_x || p.0 > 0.0);
        let (style, points) = match series.style {
            Style::Area | Style::Shade if is_map => return None,
            Style::Area => return Self::band(series),
            Style::Shade => ("shade", series.points.clone()),
            Style::Points => ("points", series.points.clone()),
            Style::Both => ("both", series.points.clone()),
            Style::Wide => ("wide", series.thinned(MAX_POINTS)),
            Style::Line => ("line", series.thinned(MAX_POINTS)),
        };
        let (x, y) = points.into_iter().filter(is_placed).unzip();
        Some(Self { name: series.name.clone(), style, x, y: vec![y] })
    }

    /// Takes an outline that runs forth along one edge and back along the other.
    fn band(series: &Series) -> Option<Self> {
        let (there, back) = series.points.split_at(series.points.len() / 2);
        let is_same = there.iter().zip(back.iter().rev()).all(|(a, b)| a.0 == b.0);
        if !is_same || there.len() != back.len() || !there.is_sorted_by(|a, b| a.0 <= b.0) {
            return None;
        }
        let (x, first): (Vec<f64>, Vec<f64>) = there.iter().copied().unzip();
        let second: Vec<f64> = back.iter().rev().map(|p| p.1).collect();
        Some(Self { name: series.name.clone(), style: "area", x, y: vec![first, second] })
    }
}

/// Columns of all charts of a page, each once.
#[derive(Clone, Debug, Default)]
pub(crate) struct Columns {
    /// Bytes of a number, and all numbers in base64.
    columns: Vec<(usize, String)>,
    places: HashMap<String, usize>,
}

/// Description of a chart in its figure, as the script reads it.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Described<'a> {
    kind: &'static str,
    title: &'a str,
    x: &'a str,
    y: &'a str,
    size: (u32, u32),
    log_x: bool,
    log_y: bool,
    equal: bool,
    series: Vec<DescribedSeries<'a>>,
}

/// Series of a described chart: places of its columns, or the ends of a shade.
#[derive(Serialize)]
#[serde(untagged)]
enum DescribedSeries<'a> {
    Shade { style: &'static str, from: f64, to: f64 },
    Curve { name: &'a str, style: &'static str, x: usize, y: Vec<usize> },
}

impl Columns {
    /// Adds the columns of a chart, and returns its description as JSON.
    pub(crate) fn describe(&mut self, plot: &Plot) -> String {
        let series = plot.series.iter().map(|curve| {
            if let ("shade", Some(&from), Some(&to)) = (curve.style, curve.x.first(), curve.x.last()) {
                let to = curve.x.iter().fold(to, |a, &b| a.max(b));
                return DescribedSeries::Shade { style: curve.style, from, to };
            }
            // Times keep their digits; of a value seven digits are shown.
            let x = self.add(8, curve.x.iter().flat_map(|v| v.to_le_bytes()).collect());
            let y = curve.y.iter();
            let y =
                y.map(|y| self.add(4, y.iter().flat_map(|&v| (v as f32).to_le_bytes()).collect())).collect();
            DescribedSeries::Curve { name: &curve.name, style: curve.style, x, y }
        });
        let described = Described {
            kind: if plot.is_map { "map" } else { "lines" },
            title: &plot.title,
            x: &plot.x,
            y: &plot.y,
            size: plot.size,
            log_x: plot.scales.log_x,
            log_y: plot.scales.log_y,
            equal: plot.scales.equal,
            series: series.collect(),
        };
        // Strings and finite numbers cannot fail.
        serde_json::to_string(&described).unwrap_or_default()
    }

    fn add(&mut self, size: usize, bytes: Vec<u8>) -> usize {
        let text = STANDARD.encode(bytes);
        *self.places.entry(text).or_insert_with_key(|text| {
            self.columns.push((size, text.clone()));
            self.columns.len() - 1
        })
    }

    /// Returns whether no chart was added.
    pub(crate) fn is_empty(&self) -> bool {
        self.columns.is_empty()
    }

    /// Returns the elements for the end of a page: all columns, and the scripts.
    pub(crate) fn render(&self) -> String {
        let mut out = String::new();
        for (index, (size, text)) in self.columns.iter().enumerate() {
            let _ = writeln!(
                out,
                "<script type=\"text/plain\" id=\"column-{index}\" data-bytes=\"{size}\">{text}</script>"
            );
        }
        let _ = writeln!(out, "<script>{}</script>", script());
        out
    }
}

/// Returns the library and the script, as they stand in a page.
fn script() -> String {
    let [charts, sketches] = SCRIPTS;
    format!("{}\n{charts}{sketches}", library())
}

/// Returns the library with its notice.
pub(crate) fn library() -> String {
    let library = LIBRARY.split_once('\n').map_or(LIBRARY, |(_, code)| code);
    format!("{NOTICE}{library}")
}

/// Returns the hash of an inline script or style, as a policy names it.
pub(crate) fn sha256(code: &str) -> String {
    format!("sha256-{}", STANDARD.encode(Sha256::digest(code)))
}

/// Returns the policy of a page: nothing is fetched, and no script runs but that of this crate.
pub(crate) fn policy() -> String {
    format!(
        "default-src 'none'; style-src 'unsafe-inline'; script-src '{}'; img-src data: blob:; base-uri \
         'none'; form-action 'none'",
        sha256(&script())
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    const CHART: Chart = Chart { title: "t", x: "time, s", y: "N", size: (400, 300) };

    fn described(series: &[Series], scales: Scales) -> serde_json::Value {
        let plot = Plot::new(&CHART, series, scales).unwrap();
        serde_json::from_str(&Columns::default().describe(&plot)).unwrap()
    }

    #[test]
    fn columns_keep_their_numbers_and_are_stored_once() {
        let line = |name| Series::new(name, [0.0, 0.1, 0.2], [1.5, f64::NAN, -2.0]);
        let plot = Plot::new(&CHART, &[line("a"), line("b")], Scales::default()).unwrap();
        let mut columns = Columns::default();
        let first = columns.describe(&plot);
        assert_eq!(first, columns.describe(&plot));
        assert_eq!(columns.columns.len(), 2);
        let read = |index: usize| STANDARD.decode(&columns.columns[index].1).unwrap();
        let x: Vec<f64> = read(0).chunks(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect();
        let y: Vec<f32> = read(1).chunks(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect();
        assert_eq!(x, [0.0, 0.1, 0.2]);
        assert!(y[0] == 1.5 && y[1].is_nan() && y[2] == -2.0);
    }

    #[test]
    fn a_band_has_both_edges_and_another_outline_keeps_its_picture() {
        let band = Series::through("band", vec![(0.0, 1.0), (1.0, 2.0), (1.0, -2.0), (0.0, -1.0)]);
        let line = Series::new("line", [0.0, 1.0], [0.0, 0.5]);
        let json = described(&[band.styled(Style::Area), line.clone()], Scales::default());
        assert_eq!(json["series"][0]["style"], "area");
        assert_eq!(json["series"][0]["y"].as_array().unwrap().len(), 2);
        let triangle = Series::through("triangle", vec![(0.0, 0.0), (1.0, 2.0), (2.0, 0.0)]);
        assert!(Plot::new(&CHART, &[line, triangle.styled(Style::Area)], Scales::default()).is_none());
    }

    #[test]
    fn a_curve_that_turns_back_is_a_map_and_a_shade_has_two_ends() {
        let line = Series::new("line", [0.0, 1.0, 2.0], [-3.0, 5.0, 1.0]);
        let shade = Series::shade("start", (0.0, 0.5), core::slice::from_ref(&line));
        let json = described(&[line, shade], Scales::default());
        assert_eq!((&json["kind"], &json["series"][1]["to"]), (&"lines".into(), &0.5.into()));
        let loops = Series::through("loop", vec![(0.0, 1.0), (1.0, 2.0), (0.5, 0.0)]);
        assert_eq!(described(&[loops], Scales::default())["kind"], "map");
    }

    #[test]
    fn a_logarithmic_axis_has_no_place_for_zero() {
        let line = Series::new("line", [0.0, 1.0, 10.0], [1.0, 2.0, 3.0]);
        let plot = Plot::new(&CHART, &[line], Scales { log_x: true, ..Scales::default() }).unwrap();
        assert_eq!(plot.series[0].x, [1.0, 10.0]);
        assert!(Plot::new(&CHART, &[], Scales::default()).is_none());
    }

    #[test]
    fn the_policy_allows_exactly_the_script_of_the_page() {
        let mut columns = Columns::default();
        let line = Series::new("line", [0.0, 1.0], [1.0, 2.0]);
        columns.describe(&Plot::new(&CHART, &[line], Scales::default()).unwrap());
        let html = columns.render();
        let code = html.rsplit_once("<script>").unwrap().1.split_once("</script>").unwrap().0;
        let hash = STANDARD.encode(Sha256::digest(code));
        assert!(policy().contains(&format!("'sha256-{hash}'")));
        assert!(!html.contains("://"), "a page must not reach outside");
    }
}
