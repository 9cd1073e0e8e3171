//! Table and page of a comparison.

use super::read::StoredRun;
use super::{Comparison, Difference, TextRow, difference};
use crate::cli::label::label;
use diagnosis::four_digits;
use report::figure::{Chart, Series, lines};
use report::page::Page;

const SIZE: (u32, u32) = (1040, 300);
const DIFFERENCE_SIZE: (u32, u32) = (1040, 200);

/// Name of a nested figure in words: `error_bars.peak_n` is `error bars: peak, N`, and of
/// `peak_times_s.peak_n` the group has the unit.
fn nested_label(name: &str) -> String {
    let Some((above, name)) = name.rsplit_once('.') else { return label(name) };
    let (above, name) = (label(&above.replace('.', "_")), label(name));
    match (above.split_once(", "), name.split_once(", ")) {
        (Some((above, unit)), Some((name, _))) => format!("{above}: {name}, {unit}"),
        _ => format!("{above}: {name}"),
    }
}

/// Header of a table with a column for each run.
fn header(comparison: &Comparison, first: &str) -> Vec<String> {
    [first.to_owned()].into_iter().chain(comparison.runs.iter().cloned()).collect()
}

/// Figures that differ, with the difference from the first run.
pub(crate) fn figures(comparison: &Comparison) -> (Vec<String>, Vec<Vec<String>>) {
    let changed = comparison.figures.iter().filter(|row| row.differences.iter().any(|d| *d != 0.0));
    let rows = changed.map(|row| {
        let cells = row.values.iter().zip(&row.differences).enumerate().map(|(run, (value, difference))| {
            let sign = if *difference < 0.0 { "" } else { "+" };
            match run {
                0 => four_digits(*value),
                _ => format!("{} ({sign}{})", four_digits(*value), four_digits(*difference)),
            }
        });
        [nested_label(&row.name)].into_iter().chain(cells).collect()
    });
    (header(comparison, "figure"), rows.collect())
}

/// Texts that differ.
pub(crate) fn texts(comparison: &Comparison) -> (Vec<String>, Vec<Vec<String>>) {
    let row =
        |row: &TextRow| [nested_label(&row.name)].into_iter().chain(row.values.iter().cloned()).collect();
    (header(comparison, "text"), comparison.texts.iter().map(row).collect())
}

/// Differences of the logs' columns from the first run, rms and largest.
pub(crate) fn columns(comparison: &Comparison) -> (Vec<String>, Vec<Vec<String>>) {
    let rows = comparison.columns.iter().map(|row| {
        let cells = row.differences.iter().enumerate().map(|(run, difference)| match run {
            0 => "reference".to_owned(),
            _ => difference.map_or_else(|| "no common values".into(), in_words),
        });
        [label(&row.name)].into_iter().chain(cells).collect()
    });
    (header(comparison, "column of the log"), rows.collect())
}

fn in_words(difference: Difference) -> String {
    let [rms, max, time_s] = [difference.rms, difference.max, difference.time_s].map(four_digits);
    if difference.max == 0.0 { "equal".into() } else { format!("{rms} rms, {max} at {time_s} s") }
}

/// Draws the page. The error describes a failure to draw.
pub(crate) fn page(comparison: &Comparison, runs: &[StoredRun]) -> Result<Page, String> {
    let mut page = Page::new("Comparison of runs");
    let same = comparison.figures.iter().filter(|row| row.differences.iter().all(|d| *d == 0.0)).count();
    page.lead(&format!(
        "{} runs; differences are those from {}. {same} of {} figures are equal and not listed.",
        runs.len(),
        comparison.runs.first().map_or("", String::as_str),
        comparison.figures.len()
    ));
    let add = |page: &mut Page, (header, rows): (Vec<String>, Vec<Vec<String>>)| {
        let header: Vec<&str> = header.iter().map(String::as_str).collect();
        page.table(&header, &rows);
    };
    page.section("Figures");
    add(&mut page, figures(comparison));
    if !comparison.texts.is_empty() {
        add(&mut page, texts(comparison));
    }
    page.section("Logs");
    add(&mut page, columns(comparison));
    if !comparison.missing.is_empty() {
        page.note(&format!("Not in all runs: {}.", comparison.missing.join(", ")));
    }
    let Some(first) = runs.first() else { return Ok(page) };
    for row in &comparison.columns {
        draw(&mut page, comparison, first, runs, &row.name)?;
    }
    Ok(page)
}

/// Draws a column of all runs, and the differences of those that differ.
fn draw(
    page: &mut Page,
    comparison: &Comparison,
    first: &StoredRun,
    runs: &[StoredRun],
    name: &str,
) -> Result<(), String> {
    let words = label(name);
    let (title, unit) = words.split_once(", ").unwrap_or((&words, ""));
    let names = || comparison.runs.iter().zip(runs);
    let curves = names().filter_map(|(path, run)| {
        Some(Series::new(path, run.times_s.iter().copied(), run.column(name)?.iter().copied()))
    });
    let chart = Chart { title, x: "time, s", y: unit, size: SIZE };
    page.figure(&lines(&chart, &curves.collect::<Vec<_>>())?, "Every row of the logs.");
    // The first run is a line at zero: so all runs keep their colours.
    let differences =
        names().filter_map(|(path, run)| Some(Series::through(path, difference(first, run, name)?)));
    let differences: Vec<Series> = differences.collect();
    if differences.iter().flat_map(|series| &series.points).any(|point| point.1 != 0.0) {
        let title = format!("{title}: difference from the first run");
        let chart = Chart { title: &title, x: "time, s", y: unit, size: DIFFERENCE_SIZE };
        page.figure(&lines(&chart, &differences)?, "At the times of each run.");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nested_figures_have_the_unit_of_their_group_if_it_has_one() {
        assert_eq!(nested_label("peak_contact_force_n"), "peak contact force, N");
        assert_eq!(nested_label("error_bars.peak_contact_force_n"), "error bars: peak contact force, N");
        assert_eq!(nested_label("peak_times_s.peak_contact_force_n"), "peak times: peak contact force, s");
    }
}
