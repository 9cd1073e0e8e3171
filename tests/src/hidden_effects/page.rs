//! What is published: a table of goals and figures for the terminal, and `docs/hidden-effects.md`.

use super::cell::Campaign;
use super::goals::Goal;
use super::score::{Figures, Shares};
use crate::generator::session::Plant;
use std::fmt::Write as _;

const HEAD: &str = "# Hidden effects: what the diagnosis finds

Logs come from generators that share no code with the engine (`tests/src/generator`), hide an effect of the vocabulary or none, and
the engine answers from the log alone; labels are sealed until it has. This page is written by
`cargo xtask hidden-effects --bless` from its golden figures under `tests/golden`, which are those of the run named below. The axes have the page
`hidden-effects.md`, the transmission bench, a cell of which costs fifty times as much, `hidden-effects-bench.md`, and the same with a shaft that may
tilt in its bearing, a hundred times as much, `hidden-effects-two-plane.md`.

Size is the rms of the part of the effect that calibration cannot absorb over the rms of the noise floor, over all samples of all
channels, each in units of its own noise; calibration may move what is declared uncertain by four declared deviations. A share counts the
cells in which the plant can show the wanted size at all. An equivalent cause is one that imitates the hidden effect
on that log but for a rest of size .1, of a small effect but for half of its own size. Parameter errors and intervals are those of cells whose first cause is right, whose number stands
beside them; of a size with several parameters (the two parts of a phase) the error is |found - hidden| over |hidden|. Predicted
and realised gain are compared in every cell of size .5 and more with a cause and a predicted gain, right or wrong.

Plants: `rotary`, a friction rig with drive torque and friction torque; `linear`, a cylinder of which only the force is
measured; `bench`, transmission bench B; `two-plane`, the same with a shaft that may tilt, the only one that shows `misalignment`.

Hard conditions, on the axes: strokes with rests in place of a swing, a sign of friction 1 mm/s wide in place of 6 and 12, 200 samples a
second in place of 250, efforts read to half of their noise in place of a tenth, the load five times as noisy on `linear`.
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

/// The name of the page and of its golden figures: each transmission bench by itself has its own.
pub fn stem(figures: &Figures) -> &'static str {
    match figures.campaign.as_ref().map(|c| c.plants.as_slice()) {
        Some([Plant::Bench]) => "hidden-effects-bench",
        Some([Plant::TwoPlane]) => "hidden-effects-two-plane",
        _ => "hidden-effects",
    }
}

/// The goals beside what was found, as text.
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

/// The page.
pub fn page(figures: &Figures) -> String {
    let mut page = String::from(HEAD);
    let ran: Vec<String> = figures.ran.iter().map(|(plant, n)| format!("{n} cells of `{plant}`")).collect();
    let seeds = |read: fn(&Campaign) -> u64| match &figures.campaign {
        Some(c) if read(c) > 0 => format!("{} to {}", c.skipped_seeds + 1, c.skipped_seeds + read(c)),
        _ => "none".into(),
    };
    let planned = figures.campaign.as_ref().map_or(0, |c| c.cells().len());
    let count: usize = figures.ran.values().sum::<usize>() + figures.out_of_reach.values().sum::<usize>();
    let _ = writeln!(
        page,
        "\nRun of {}: seeds of every cell {} (axes) and {} (bench), {} of {} cells; with an answer: {}. Cells run in a shuffled \
         order, so a run that is cut short is a sample of them.",
        figures.date,
        seeds(|c| c.seeds),
        seeds(|c| c.bench_seeds),
        count,
        planned,
        ran.join(", ")
    );
    for note in &figures.notes {
        let _ = writeln!(page, "\n{note}");
    }
    head(&mut page, "Goals", &["figure", "goal", "found", "cells", ""]);
    for goal in figures.goals() {
        let cells = goal.cells.to_string();
        row(&mut page, &[goal.name, &wanted(&goal), &number(goal.found), &cells, mark(&goal)]);
    }
    let of_map = |map: &std::collections::BTreeMap<String, Shares>| map.clone().into_iter();
    shares(&mut page, "Single effects by size", "size", of_map(&figures.by_size));
    shares(&mut page, "Single effects of size .5 and more", "plant, effect", of_map(&figures.by_effect));
    shares(
        &mut page,
        "Outside the library: the hidden cause is deleted, size 1",
        "",
        std::iter::once((String::new(), figures.deleted.clone())),
    );
    shares(&mut page, "Hard conditions, size 1", "", std::iter::once((String::new(), figures.hard.clone())));
    head(&mut page, "Clean logs, two effects, pairs, changed questions", &["question", "cells", "share"]);
    for (plant, s) in &figures.false_alarms {
        let name = format!("clean log of `{plant}`: any answer but none");
        row(&mut page, &[&name, &s.cells.to_string(), &format!("{:.3}", s.share)]);
    }
    let rows = [
        ("clean log: a cause named", &figures.false_names),
        ("clean log under hard conditions: any answer but none", &figures.hard_false_alarms),
        ("clean log under hard conditions: a cause named", &figures.hard_false_names),
        ("two effects: both in the group", &figures.both),
        ("two effects: a third cause", &figures.third),
        ("inseparable pair: both named", &figures.pair_named),
        ("of those, settled by the proposed experiment and the logs at hand", &figures.pair_settled),
        ("of those, said that no experiment of the menu tells", &figures.pair_hopeless),
        ("95 % intervals that hold the truth", &figures.covered),
        ("realised gain within 20 % of the predicted", &figures.gain_within),
    ];
    for (name, s) in rows {
        row(&mut page, &[name, &s.cells.to_string(), &format!("{:.3}", s.share)]);
    }
    for (change, s) in &figures.changed {
        row(
            &mut page,
            &[&format!("same answer, changed: {change}"), &s.cells.to_string(), &format!("{:.3}", s.share)],
        );
    }
    let _ = writeln!(
        page,
        "\nA second session shrinks intervals by a factor of {} (median of the cells with the same answer; root of two: 1.414).",
        number(figures.shrink)
    );
    let bins = [
        ("all arms", &figures.calibration_of_all, figures.calibration_error_of_all),
        ("single effects", &figures.calibration, figures.calibration_error),
    ];
    for (of, bins, error) in bins {
        let title = format!("Stated probability of the first cause, {of}: error {}", number(error));
        head(&mut page, &title, &["cells", "mean stated", "right or equivalent"]);
        for (n, stated, hit) in bins {
            row(&mut page, &[&n.to_string(), &format!("{stated:.3}"), &format!("{hit:.3}")]);
        }
    }
    head(&mut page, "First names at size .5 and more", &["hidden", "named (cells)"]);
    for (hidden, names) in &figures.confusion {
        let mut names: Vec<(&String, &usize)> = names.iter().collect();
        names.sort_by(|a, b| b.1.cmp(a.1));
        let names: Vec<String> = names.iter().map(|(name, n)| format!("{name} ({n})")).collect();
        row(&mut page, &[hidden, &names.join(", ")]);
    }
    if !figures.out_of_reach.is_empty() {
        head(
            &mut page,
            "Cells that were not asked: the size is out of the plant's reach, or the pair does not look alike",
            &["arm, plant, effects", "cells"],
        );
        for (name, n) in &figures.out_of_reach {
            row(&mut page, &[name, &n.to_string()]);
        }
    }
    page
}
