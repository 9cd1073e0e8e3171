//! The README's excerpt of the default run, and the pictures of the documents that are charts of
//! reports.

use crate::document::Block;
use crate::run::{ChoreError, output_of, root, target_folder, write_atomically};
use crate::workspace;
use std::path::PathBuf;

/// Place of the excerpt.
const EXCERPT: Block = Block { file: "README.md", name: "run" };
/// Pictures: file, arguments of the command that writes the report, title of the chart.
const PICTURES: [Picture; 3] = [
    Picture { file: "docs/images/estimate.svg", arguments: &["run"], title: "Estimated contact force" },
    Picture {
        file: "docs/images/four-bar.svg",
        arguments: &["run", "--bench", "examples/four-bar.toml"],
        title: "Contact force",
    },
    Picture {
        file: "docs/images/diagnosis.svg",
        arguments: &["diagnose", "examples/logs/servo-axis.mat", "--bench", "examples/servo-axis.toml"],
        title: "drive_torque_nm over speed",
    },
];
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

/// A picture of the documents: a chart of a report.
#[derive(Clone, Copy, Debug)]
struct Picture {
    /// Path relative to the workspace.
    file: &'static str,
    /// Arguments of `host-sim`.
    arguments: &'static [&'static str],
    /// Title of the chart.
    title: &'static str,
}

impl Picture {
    /// Runs the command. Returns its output and the chart.
    fn draw(self) -> Result<(String, String), ChoreError> {
        let out = target_folder().join("readme");
        let mut command = workspace::program("host-sim")?;
        let printed = output_of(command.args(self.arguments).arg("--out").arg(&out))?;
        let file = out.join("report.html");
        let report = read(file.clone())?;
        let chart = chart(&report, self.title);
        let chart = chart.ok_or_else(|| missing(file, "no such chart".into(), self.title))?;
        Ok((printed, chart + "\n"))
    }
}

/// Runs the commands. Returns the README's excerpt and the pictures.
fn draw_all() -> Result<(String, Vec<(Picture, String)>), ChoreError> {
    let mut drawn = vec![];
    let mut excerpt = String::new();
    for picture in PICTURES {
        let (printed, chart) = picture.draw()?;
        if picture.arguments == ["run"] {
            let line = |start: &&str| printed.lines().find(|line| line.starts_with(start));
            let lines: Option<Vec<&str>> = LINES.iter().map(line).collect();
            let lines = lines
                .ok_or_else(|| missing("output of `host-sim run`", printed.clone(), "the README's lines"))?;
            excerpt = format!("```text\n{}\n```", lines.join("\n"));
        }
        drawn.push((picture, chart));
    }
    Ok((excerpt, drawn))
}

/// Returns the chart with the title from the text of a report.
fn chart(report: &str, title: &str) -> Option<String> {
    let title = format!(">\n{title}\n<");
    let charts = report.split_inclusive("</svg>").filter_map(|part| part.find("<svg").map(|at| &part[at..]));
    charts.into_iter().find(|chart| chart.contains(&title)).map(str::to_owned)
}

fn missing(file: impl Into<PathBuf>, found: String, expected: &'static str) -> ChoreError {
    ChoreError::File { file: file.into(), found, expected }
}

fn read(file: PathBuf) -> Result<String, ChoreError> {
    std::fs::read_to_string(&file)
        .map_err(|error| missing(file, error.to_string(), "a file that can be read"))
}

/// Writes excerpt and pictures.
pub(crate) fn bless() -> Result<(), ChoreError> {
    let (excerpt, drawn) = draw_all()?;
    EXCERPT.write(&excerpt)?;
    drawn.into_iter().try_for_each(|(picture, chart)| write_atomically(root().join(picture.file), chart))
}

/// Compares excerpt and pictures with new runs.
pub(crate) fn check() -> Result<(), ChoreError> {
    let (excerpt, drawn) = draw_all()?;
    EXCERPT.check(&excerpt)?;
    for (picture, chart) in drawn {
        if read(root().join(picture.file))? != chart {
            return Err(ChoreError::Differs {
                what: picture.file.into(),
                found: "another picture than that of a new run".into(),
                expected: "the same bytes; if the change is intended: cargo xtask bless".into(),
            });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_chart_with_the_title_is_taken_from_a_report() {
        let report = "<p><svg a>x</svg><p><svg b><text>\nForce\n</text></svg>";
        assert_eq!(chart(report, "Force").unwrap(), "<svg b><text>\nForce\n</text></svg>");
        assert_eq!(chart(report, "For"), None);
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
