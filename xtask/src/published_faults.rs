//! Published fault campaigns in `docs/figures.md`.

use crate::document::Block;
use crate::run::{ChoreError, root};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fmt::Write;

/// File that `cargo xtask faults --publish` appends to.
const FILE: &str = "tests/golden/faults-published.json";
/// Place of the tables.
const TABLES: Block = Block { file: "docs/figures.md", name: "published-faults" };

#[derive(Deserialize)]
struct Publication {
    date: String,
    build: String,
    seed: u64,
    count: u64,
    table: Option<Counts>,
}

#[derive(Deserialize)]
struct Counts {
    kinds: BTreeMap<String, Row>,
    all: Row,
}

#[derive(Deserialize)]
struct Row {
    faults: u32,
    detected: u32,
    wrong_again: u32,
    detected_late: u32,
    harmless: u32,
    silent: u32,
    late_longest: Option<u32>,
}

/// Writes the tables of the last publication.
pub(crate) fn bless() -> Result<(), ChoreError> {
    TABLES.write(&render()?)
}

fn render() -> Result<String, ChoreError> {
    let file = root().join(FILE);
    let expected = "what `cargo xtask faults --publish` writes";
    let wrong = |found: String| ChoreError::File { file: file.clone(), found, expected };
    let text = std::fs::read_to_string(&file).map_err(|error| wrong(error.to_string()))?;
    let published: Vec<Publication> =
        serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))?;
    let ended =
        published.iter().rev().find_map(|publication| Some((publication, publication.table.as_ref()?)));
    let (last, counts) = ended.ok_or_else(|| wrong("no publication that has ended".into()))?;
    let mut text = format!(
        "{} faults of the fresh seed {}, image `{}`, {}:\n\n\
         | disturbed | faults | detected | wrong again | detected late | harmless | silent | \
         late by at most, samples |\n|---|---|---|---|---|---|---|---|\n",
        last.count, last.seed, last.build, last.date
    );
    let rows = counts.kinds.iter().map(|(kind, row)| (kind.as_str(), row));
    for (kind, row) in rows.chain([("**all**", &counts.all)]) {
        let late = row.late_longest.map_or_else(|| "-".into(), |late| late.to_string());
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "| {kind} | {} | {} | {} | {} | {} | {} | {late} |",
            row.faults, row.detected, row.wrong_again, row.detected_late, row.harmless, row.silent
        );
    }
    for open in published.iter().filter(|publication| publication.table.is_none()) {
        let _ =
            writeln!(text, "\nNot ended: {} faults of seed {}, begun {}.", open.count, open.seed, open.date);
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_of_figures_shows_the_last_publication() {
        TABLES.check(&render().unwrap()).unwrap();
    }
}
