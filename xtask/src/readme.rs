//! The README's excerpt and picture of the default run, both taken from that run.

use crate::document::Block;
use crate::run::{ChoreError, output_of, root, target_folder, write_atomically};
use crate::workspace;
use std::path::PathBuf;

/// Place of the excerpt.
const EXCERPT: Block = Block { file: "README.md", name: "run" };
/// Picture of the estimate, relative to the workspace.
const PICTURE: &str = "docs/images/estimate.svg";
/// Title of that picture in the report of a run.
const TITLE: &str = "Estimated contact force";
/// First words of the lines that the README shows. None of them depends on the machine's speed.
const LINES: [&str; 10] = [
    "bearing  ",
    "peak contact force  ",
    "peak friction torque",
    "largest deformation",
    "oscillation, rms",
    "energy residual",
    "peak contact force of the analytic law",
    "estimator, rms error of the force",
    "estimator, rms error of full scale",
    "estimator, deadline misses",
];

/// Excerpt and picture of one run.
struct Shown {
    excerpt: String,
    picture: String,
}

/// Runs the default bench and picks what the README shows.
fn run_default() -> Result<Shown, ChoreError> {
    let out = target_folder().join("readme");
    let printed = output_of(workspace::program("host-sim")?.args(["run", "--out"]).arg(&out))?;
    let line = |start: &&str| printed.lines().find(|line| line.starts_with(start));
    let lines: Option<Vec<&str>> = LINES.iter().map(line).collect();
    let lines =
        lines.ok_or_else(|| missing("output of `host-sim run`", printed.clone(), "the README's lines"))?;
    let file = out.join("report.html");
    let report = read(file.clone())?;
    let picture = picture(&report).ok_or_else(|| missing(file, "no such chart".into(), TITLE))?;
    Ok(Shown { excerpt: format!("```text\n{}\n```", lines.join("\n")), picture: picture + "\n" })
}

/// Returns the chart with the title from the text of a report.
fn picture(report: &str) -> Option<String> {
    let charts = report.split_inclusive("</svg>").filter_map(|part| part.find("<svg").map(|at| &part[at..]));
    charts.into_iter().find(|chart| chart.contains(TITLE)).map(str::to_owned)
}

fn missing(file: impl Into<PathBuf>, found: String, expected: &'static str) -> ChoreError {
    ChoreError::File { file: file.into(), found, expected }
}

fn read(file: PathBuf) -> Result<String, ChoreError> {
    std::fs::read_to_string(&file)
        .map_err(|error| missing(file, error.to_string(), "a file that can be read"))
}

/// Writes excerpt and picture.
pub(crate) fn bless() -> Result<(), ChoreError> {
    let shown = run_default()?;
    EXCERPT.write(&shown.excerpt)?;
    write_atomically(root().join(PICTURE), shown.picture)
}

/// Compares excerpt and picture with a new run.
pub(crate) fn check() -> Result<(), ChoreError> {
    let shown = run_default()?;
    EXCERPT.check(&shown.excerpt)?;
    if read(root().join(PICTURE))? == shown.picture {
        return Ok(());
    }
    Err(ChoreError::Differs {
        what: PICTURE.into(),
        found: "another picture than that of a new run".into(),
        expected: "the same bytes; if the change is intended: cargo xtask bless".into(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_chart_with_the_title_is_taken_from_a_report() {
        let report = format!("<p><svg a>x</svg><p><svg b>{TITLE}</svg>");
        assert_eq!(picture(&report).unwrap(), format!("<svg b>{TITLE}</svg>"));
        assert_eq!(picture("<svg a>x</svg>"), None);
    }

    /// First cells of a document's table rows, each with the numbers of the second cell.
    fn rows(file: &str) -> Vec<(String, Vec<String>)> {
        let text = read(root().join(file)).unwrap();
        let rows = text.lines().filter_map(|line| line.strip_prefix("| ")?.split_once(" | "));
        let numbers = |cell: &str| {
            let parts = cell.split(|c: char| !c.is_ascii_digit() && c != '.').map(str::to_owned);
            parts.filter(|part| part.parse::<f64>().is_ok()).collect()
        };
        rows.map(|(first, rest)| (first.to_owned(), numbers(rest.split(" |").next().unwrap()))).collect()
    }

    #[test]
    fn the_readme_shows_the_accuracy_of_the_page_of_figures_rounded() {
        let (readme, page) = (rows("README.md"), rows("docs/figures.md"));
        for name in ["all parameters", "clearance:", "nothing:"] {
            let [(_, shown), (_, figures)] =
                [&readme, &page].map(|rows| rows.iter().find(|(first, _)| first.contains(name)).unwrap());
            let rounded = shown.iter().zip(figures).map(|(shown, figure)| {
                let decimals = shown.split_once('.').map_or(0, |(_, decimals)| decimals.len());
                format!("{:.decimals$}", figure.parse::<f64>().unwrap())
            });
            assert!(
                !shown.is_empty() && *shown == rounded.collect::<Vec<_>>(),
                "{name}: {shown:?} {figures:?}"
            );
        }
    }

    #[test]
    fn the_readme_has_at_most_a_thousand_words() {
        let readme = read(root().join("README.md")).unwrap();
        assert!(readme.split_whitespace().count() <= 1000);
    }
}
