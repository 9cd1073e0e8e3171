//! Golden figures: what was counted, checked in; and the README's copy of it.
//!
//! Counts are exact for the compiler that is pinned. With another one (Debian's), only the budgets hold.

use crate::insn::{Counts, count};
use crate::run::{ChoreError, root, write_whole};
use crate::setup::{TARGET, Way, target};
use crate::table::render;
use std::path::PathBuf;

/// The file with the counts.
const FILE: &str = "tests/golden/instructions.json";
/// Around the tables in the README.
const BEGIN: &str = "<!-- instructions: cargo xtask bless -->\n";
const END: &str = "<!-- end of instructions -->\n";

/// Most instructions of the reference network: whole window, moved window, stream.
const BUDGETS: [u64; 3] = [203_000, 75_000, 10_000];
/// Most instructions of a controller tick, whatever the sample.
const TICK_BUDGET: u64 = 8_000;

fn path() -> PathBuf {
    root().join(FILE)
}

fn read(file: PathBuf) -> Result<String, ChoreError> {
    std::fs::read_to_string(&file).map_err(|error| ChoreError::File {
        file,
        found: error.to_string(),
        expected: "a file that `cargo xtask bless` writes",
    })
}

/// The counts that are checked in.
fn golden() -> Result<Counts, ChoreError> {
    serde_json::from_str(&read(path())?).map_err(|error| ChoreError::File {
        file: path(),
        found: error.to_string(),
        expected: "counts as `cargo xtask bless` writes them",
    })
}

/// The README with the tables of these counts.
fn readme_with(counts: &Counts, readme: &str) -> Option<String> {
    let (before, rest) = readme.split_once(BEGIN)?;
    let (_, after) = rest.split_once(END)?;
    Some(format!("{before}{BEGIN}\n{}\n{END}{after}", render(counts)))
}

fn no_markers() -> ChoreError {
    ChoreError::File {
        file: root().join("README.md"),
        found: "no place for the instruction counts".into(),
        expected: "the two comments around them",
    }
}

/// Counts anew and writes file and README.
pub(crate) fn bless() -> Result<(), ChoreError> {
    let counts = count()?;
    let readme = root().join("README.md");
    let text = readme_with(&counts, &read(readme.clone())?).ok_or_else(no_markers)?;
    let json = serde_json::to_string_pretty(&counts).unwrap_or_default() + "\n";
    for (file, text) in [(path(), json), (readme, text)] {
        write_whole(file, &text)?;
    }
    Ok(())
}

/// Counts anew and compares with the budgets and with the golden figures.
pub(crate) fn check() -> Result<(), ChoreError> {
    let found = count()?;
    let spent = [found.reference_window, found.reference_reuse, found.reference_stream];
    if spent.iter().zip(BUDGETS).any(|(&spent, budget)| spent > budget) {
        return Err(ChoreError::Differs {
            what: "instructions of the reference network".into(),
            found: format!("{spent:?}"),
            expected: format!("at most {BUDGETS:?}"),
        });
    }
    let tick = found.estimator_tick_max.max(found.troubled_tick_max);
    if tick > TICK_BUDGET {
        return Err(ChoreError::Differs {
            what: "most instructions of a controller tick".into(),
            found: tick.to_string(),
            expected: format!("at most {TICK_BUDGET}"),
        });
    }
    let changing = found.figures.iter().find(|(_, figure)| figure.min != figure.max);
    if let Some((name, figure)) = changing {
        return Err(ChoreError::Differs {
            what: format!("instructions of {name} over random inputs"),
            found: format!("{} to {}", figure.min, figure.max),
            expected: "one number".into(),
        });
    }
    if target(TARGET)? == Way::Debian {
        eprintln!("another compiler than the pinned one: budgets hold, golden figures not compared");
        return Ok(());
    }
    let golden = golden()?;
    if found == golden {
        return Ok(());
    }
    Err(ChoreError::Differs {
        what: format!("instruction counts ({FILE}; if the change is meant: cargo xtask bless)"),
        found: serde_json::to_string_pretty(&found).unwrap_or_default(),
        expected: serde_json::to_string_pretty(&golden).unwrap_or_default(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_crates_readme_tells_what_it_takes() {
        let readme = std::fs::read_to_string(root().join("crates/inference/README.md")).unwrap();
        let counts = golden().unwrap();
        for figure in [
            format!("{} bytes of RAM", counts.pair_ram_bytes),
            format!("{} bytes of flash", counts.least_flash_bytes),
        ] {
            assert!(readme.contains(&figure), "crates/inference/README.md: {figure}");
        }
    }

    #[test]
    fn the_readme_shows_the_golden_figures() {
        let readme = std::fs::read_to_string(root().join("README.md")).unwrap();
        let counts = golden().unwrap();
        assert_eq!(readme_with(&counts, &readme).unwrap(), readme, "cargo xtask bless writes both");
        let spent = [counts.reference_window, counts.reference_reuse, counts.reference_stream];
        assert!(spent.iter().zip(BUDGETS).all(|(&spent, budget)| spent <= budget), "{spent:?}");
        assert!(counts.estimator_tick_max.max(counts.troubled_tick_max) <= TICK_BUDGET);
        assert!(counts.figures.values().all(|figure| figure.min == figure.max), "data-dependent counts");
    }
}
