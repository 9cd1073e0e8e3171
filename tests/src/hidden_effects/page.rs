//! Published results: a table of goals and figures for the terminal, and the pages
//! `docs/hidden-effects*.md`.

use super::cell::Campaign;
use super::goals::Goal;
use super::score::{Figures, Share, Shares};
use crate::generator::plant::Plant;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Maximum width of prose in Markdown, in characters.
const MAX_WIDTH: usize = 100;

const HEAD: &str = "# Hidden effects: what the diagnosis finds

Generators write logs that hide an effect of the vocabulary or none. They share no code with the engine \
(`tests/src/generator`). The engine diagnoses each log without knowing what it hides. \
`cargo xtask hidden-effects --bless` writes this page from the golden figures of the run named below \
(`tests/golden`). The axes have the page `hidden-effects.md`. The transmission bench has \
`hidden-effects-bench.md`; one of its cells costs as much as fifty of an axis. The same bench with a \
shaft that may tilt has `hidden-effects-two-plane.md`; a cell costs as much as a hundred.

Size is the rms of the part of the effect that calibration cannot absorb, over the rms of the noise \
floor. The rms goes over all samples of all channels, each in units of its noise. Calibration may \
move each declared-uncertain parameter by four declared deviations. A share counts the cells in which \
the plant can show the requested size.

An equivalent cause imitates the hidden effect on that log up to a remainder of size .1; for a small \
effect, up to half of its size. Parameter errors and intervals count the cells whose first cause is \
right; the table has their number. A size with several parameters (the two parts of a phase) has the \
error |found - hidden| / |hidden|. Predicted and measured gain are compared in every cell of size .5 \
and more with a cause and a predicted gain, right or wrong.

Plants: `rotary` is a friction rig with drive torque and friction torque; `linear` is a cylinder of \
which only the force is measured; `bench` is transmission bench B; `two-plane` is the same with a shaft \
that may tilt, the only plant that shows `misalignment`.

Hard conditions, on the axes: strokes with standstill instead of a swing; a friction sign 1 mm/s wide \
instead of 6 and 12 mm/s; 200 samples a second instead of 250; a resolution of the efforts of half \
their noise instead of a tenth; five times the noise of the load on `linear`.
";

/// Limits of every page, after those that depend on its figures.
const LIMITS: &str =
    "* The row \"a third cause\" could not fail in this run: it counts answers with more than two causes, \
and the engine named at most two.
* The answer `partial` counts as `unknown`; its causes have a row of their own. Runs before \
2026-11-24 are of an engine that did not give it.
* Cells with an effect have white noise, deviations of at most .8 declared deviations, and one operating \
point. Coloured noise, other loads and deviations of up to two occur in clean logs only.
* The generators have the engine's model class and constants: the same equations of effects, the same \
smooth sign of friction. The rates assume that the model has no other error.
* The error of the stated probabilities is small because most answers are certain and right. It says \
little about the rare wrong ones.
* The remarks name the commits of the engine. Where they name several, the figures mix them. Seeds that \
were used to tune thresholds are included where the remarks say so.
";

fn number(value: Option<f64>) -> String {
    value.map_or_else(|| "-".into(), |v| format!("{v:.3}"))
}

fn row(page: &mut String, cells: &[&str]) {
    let _ = writeln!(page, "| {} |", cells.join(" | "));
}

fn head(page: &mut String, title: &str, cells: &[&str]) {
    let _ = writeln!(page, "\n## {title}\n");
    row(page, cells);
    row(page, &vec!["---"; cells.len()]);
}

const SHARES: [&str; 8] =
    ["cells", "detected", "first name", "in group", "group size", "unknown", "equivalent", "wrong"];

fn shares(page: &mut String, title: &str, first: &str, rows: impl Iterator<Item = (String, Shares)>) {
    let names: Vec<&str> = std::iter::once(first).chain(SHARES).collect();
    head(page, title, &names);
    for (name, s) in rows {
        let values = [s.detected, s.first, s.in_group, s.group, s.unknown, s.equivalent, s.wrong];
        let values: Vec<String> = values.iter().map(|v| format!("{v:.2}")).collect();
        let count = s.cells.to_string();
        let cells: Vec<&str> =
            [name.as_str(), &count].into_iter().chain(values.iter().map(String::as_str)).collect();
        row(page, &cells);
    }
}

fn wanted(goal: &Goal) -> String {
    match goal.wanted {
        (least, 1.0) => format!(">= {least}"),
        (0.0, most) => format!("<= {most}"),
        (least, most) => format!("{least} to {most}"),
    }
}

fn mark(goal: &Goal) -> &'static str {
    match goal.missed_by() {
        None => "not asked",
        Some(0.0) => "reached",
        Some(_) => "missed",
    }
}

/// Returns the name of the page and of its golden figures; each transmission bench has its own.
pub fn stem(figures: &Figures) -> &'static str {
    match figures.campaign.as_ref().map(|c| c.plants.as_slice()) {
        Some([Plant::Bench]) => "hidden-effects-bench",
        Some([Plant::TwoPlane]) => "hidden-effects-two-plane",
        _ => "hidden-effects",
    }
}

/// Returns the goals and figures as text.
pub fn summary(figures: &Figures) -> String {
    let mut text = String::new();
    for goal in figures.goals() {
        let _ = writeln!(
            text,
            "{:52} {:12} {:>8}  {}",
            goal.name,
            wanted(&goal),
            number(goal.found),
            mark(&goal)
        );
    }
    text
}

/// Returns the page.
pub fn page(figures: &Figures) -> String {
    let mut page = wrap(HEAD);
    run(&mut page, figures);
    limits(&mut page, figures);
    head(&mut page, "Goals", &["figure", "goal", "found", "cells", ""]);
    for goal in figures.goals() {
        let cells = goal.cells.to_string();
        row(&mut page, &[goal.name, &wanted(&goal), &number(goal.found), &cells, mark(&goal)]);
    }
    let of_map = |map: &BTreeMap<String, Shares>| map.clone().into_iter();
    let one = |shares: &Shares| std::iter::once((String::new(), shares.clone()));
    shares(&mut page, "Single effects by size", "size", of_map(&figures.by_size));
    shares(&mut page, "Single effects of size .5 and more", "plant, effect", of_map(&figures.by_effect));
    shares(&mut page, "Outside the library: the hidden cause is deleted, size 1", "", one(&figures.deleted));
    shares(&mut page, "Hard conditions, size 1", "", one(&figures.hard));
    questions(&mut page, figures);
    calibrations(&mut page, figures);
    first_names(&mut page, figures);
    out_of_reach(&mut page, figures);
    page
}

/// Writes which cells ran, and the remarks.
fn run(page: &mut String, figures: &Figures) {
    let ran: Vec<String> = figures.ran.iter().map(|(plant, n)| format!("{n} cells of `{plant}`")).collect();
    let seeds = |read: fn(&Campaign) -> u64| match &figures.campaign {
        Some(c) if read(c) > 0 => format!("{} to {}", c.skipped_seeds + 1, c.skipped_seeds + read(c)),
        _ => "none".into(),
    };
    let planned = figures.campaign.as_ref().map_or(0, |c| c.cells().len());
    let count: usize = figures.ran.values().sum::<usize>() + figures.out_of_reach.values().sum::<usize>();
    let text = format!(
        "\nRun of {}: seeds of every cell {} (axes) and {} (bench), {count} of {planned} cells; \
         with an answer: {}. Cells run in a shuffled order, so an interrupted run is a sample of \
         them.\n",
        figures.date,
        seeds(|c| c.seeds),
        seeds(|c| c.bench_seeds),
        ran.join(", ")
    );
    page.push_str(&wrap(&text));
    for note in &figures.notes {
        page.push_str(&wrap(&format!("\n{note}\n")));
    }
}

/// Writes the limits of the page.
fn limits(page: &mut String, figures: &Figures) {
    page.push_str("\n## Limits of this page\n\n");
    let named = figures.wrong_among_named();
    if named.cells > 0 {
        page.push_str(&wrap(&format!(
            "* With the true cause deleted from the library, the engine names a cause in {} of {} \
             cells. Of these names {:.0} are wrong ({:.0} %); the others are equivalent.\n",
            named.cells,
            figures.deleted.cells,
            named.share * named.cells as f64,
            100.0 * named.share
        )));
    }
    page.push_str(&wrap(LIMITS));
}

/// Writes the shares of clean logs, two effects, pairs and changed questions.
fn questions(page: &mut String, figures: &Figures) {
    head(page, "Clean logs, two effects, pairs, changed questions", &["question", "cells", "share"]);
    let mut line =
        |name: &str, s: &Share| row(page, &[name, &s.cells.to_string(), &format!("{:.3}", s.share)]);
    for (plant, s) in &figures.false_alarms {
        line(&format!("clean log of `{plant}`: any answer but none"), s);
    }
    for (name, s) in [
        ("clean log: a cause named", &figures.false_names),
        ("clean log under hard conditions: any answer but none", &figures.hard_false_alarms),
        ("clean log under hard conditions: a cause named", &figures.hard_false_names),
        ("deleted cause: wrong, where a cause is named", &figures.wrong_among_named()),
        ("causes in partial answers: hidden, or equivalent to what is hidden", &figures.partial_names),
        ("two effects: both in the group", &figures.both),
        ("two effects: a third cause (cannot fail, see the limits)", &figures.third),
        ("inseparable pair: both named", &figures.pair_named),
        ("of those, settled by the proposed experiment and the logs at hand", &figures.pair_settled),
        ("of those, no experiment of the menu separates them, as the answer says", &figures.pair_hopeless),
        ("95 % intervals that contain the truth", &figures.covered),
        ("measured gain within 20 % of the predicted", &figures.gain_within),
    ] {
        line(name, s);
    }
    for (change, s) in &figures.changed {
        line(&format!("same answer, changed: {change}"), s);
    }
    page.push_str(&wrap(&format!(
        "\nA second record shrinks intervals by a factor of {} (median of the cells with the same \
         answer; the square root of two is 1.414).\n",
        number(figures.shrink)
    )));
}

/// Writes the stated probabilities with the rates at which they are right.
fn calibrations(page: &mut String, figures: &Figures) {
    let bins = [
        ("all arms", &figures.calibration_of_all, figures.calibration_error_of_all),
        ("single effects", &figures.calibration, figures.calibration_error),
    ];
    for (arms, bins, error) in bins {
        let title = format!("Stated probability of the first cause, {arms}: error {}", number(error));
        head(page, &title, &["cells", "mean stated", "right or equivalent"]);
        for (n, stated, hit) in bins {
            row(page, &[&n.to_string(), &format!("{stated:.3}"), &format!("{hit:.3}")]);
        }
    }
}

/// Writes the first names by hidden effect.
fn first_names(page: &mut String, figures: &Figures) {
    head(page, "First names at size .5 and more", &["hidden", "named (cells)"]);
    for (hidden, names) in &figures.confusion {
        let mut names: Vec<(&String, &usize)> = names.iter().collect();
        names.sort_by(|a, b| b.1.cmp(a.1));
        let names: Vec<String> = names.iter().map(|(name, n)| format!("{name} ({n})")).collect();
        row(page, &[hidden, &names.join(", ")]);
    }
}

/// Writes the cells that were not asked.
fn out_of_reach(page: &mut String, figures: &Figures) {
    if figures.out_of_reach.is_empty() {
        return;
    }
    let title = "Cells that were not asked: the plant cannot show the size, or the pair does not look alike";
    head(page, title, &["arm, plant, effects", "cells"]);
    for (name, n) in &figures.out_of_reach {
        row(page, &[name, &n.to_string()]);
    }
}

/// Breaks the lines of prose at the width of Markdown; items of lists keep their indent.
fn wrap(text: &str) -> String {
    let mut wrapped = String::new();
    for line in text.lines() {
        let indent = if line.starts_with("* ") { "  " } else { "" };
        let mut width = 0;
        for word in line.split(' ') {
            let length = word.chars().count();
            if width > 0 && width + 1 + length > MAX_WIDTH {
                wrapped.push('\n');
                wrapped.push_str(indent);
                width = indent.len();
            } else if width > 0 {
                wrapped.push(' ');
                width += 1;
            }
            wrapped.push_str(word);
            width += length;
        }
        wrapped.push('\n');
    }
    wrapped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prose_is_wrapped_and_items_keep_their_indent() {
        let item = format!("* {}", "word ".repeat(30).trim_end());
        let lines: Vec<String> = wrap(&item).lines().map(str::to_owned).collect();
        assert!(lines.len() == 2 && lines[1].starts_with("  word"), "{lines:?}");
        assert!(lines.iter().all(|line| line.len() <= MAX_WIDTH));
        assert_eq!(wrap("a\n\nb"), "a\n\nb\n");
    }
}
