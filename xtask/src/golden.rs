//! Golden instruction counts, and their copy in `docs/figures.md`.
//!
//! Counts are exact for the pinned compiler. With another one, only the budgets are compared.

use crate::counts::Counts;
use crate::document::Block;
use crate::insn::count;
use crate::run::{ChoreError, root, write_atomically};
use crate::setup::{TARGET, Toolchain, target};
use crate::table::render;
use std::path::PathBuf;

/// File with the golden counts.
const FILE: &str = "tests/golden/instructions.json";
/// Place of the tables.
const TABLES: Block = Block { file: "docs/figures.md", name: "instructions" };

/// Instruction budgets of the reference network: complete window, window moved by one column,
/// stream.
const BUDGETS: [u64; 3] = [203_000, 75_000, 10_000];
/// Instruction budget of a controller tick, for any sample. The goal is 11,000.
const TICK_BUDGET: u64 = 18_500;

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

/// Extent of a comparison with golden figures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Comparison {
    /// Budgets and golden figures were compared.
    Complete,
    /// Comparison with the budgets alone: the compiler is not the pinned one.
    BudgetsOnly,
}

/// Reads the golden counts.
fn golden() -> Result<Counts, ChoreError> {
    serde_json::from_str(&read(path())?).map_err(|error| ChoreError::File {
        file: path(),
        found: error.to_string(),
        expected: "counts as `cargo xtask bless` writes them",
    })
}

/// Counts instructions and writes the golden file and the tables.
pub(crate) fn bless() -> Result<(), ChoreError> {
    let counts = count()?;
    let json = serde_json::to_string_pretty(&counts).unwrap_or_default() + "\n";
    write_atomically(path(), &json)?;
    TABLES.write(&render(&counts))
}

/// Counts instructions and compares them with the budgets and with the golden counts.
pub(crate) fn check() -> Result<Comparison, ChoreError> {
    let found = count()?;
    let used = [found.reference_window, found.reference_reuse, found.reference_stream];
    if used.iter().zip(BUDGETS).any(|(&used, budget)| used > budget) {
        return Err(ChoreError::Differs {
            what: "instructions of the reference network".into(),
            found: format!("{used:?}"),
            expected: format!("at most {BUDGETS:?}"),
        });
    }
    let tick = found.estimator_tick_max.max(found.disturbed_tick_max);
    if tick > TICK_BUDGET {
        return Err(ChoreError::Differs {
            what: "maximum instructions of a controller tick".into(),
            found: tick.to_string(),
            expected: format!("at most {TICK_BUDGET}"),
        });
    }
    // The networks take the same time for any data; the Kalman filter does not.
    let is_constant = |name: &str| !name.starts_with("filter");
    let varying = (found.figures.iter()).find(|(name, figure)| is_constant(name) && figure.min != figure.max);
    if let Some((name, figure)) = varying {
        return Err(ChoreError::Differs {
            what: format!("instructions of {name} over random inputs"),
            found: format!("{} to {}", figure.min, figure.max),
            expected: "one number".into(),
        });
    }
    if target(TARGET)? == Toolchain::Debian {
        return Ok(Comparison::BudgetsOnly);
    }
    let golden = golden()?;
    if found == golden {
        return Ok(Comparison::Complete);
    }
    Err(ChoreError::Differs {
        what: format!("instruction counts ({FILE}; if the change is intended: cargo xtask bless)"),
        found: serde_json::to_string_pretty(&found).unwrap_or_default(),
        expected: serde_json::to_string_pretty(&golden).unwrap_or_default(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::counts::Figure;

    #[test]
    fn the_readme_of_inference_shows_the_golden_sizes() {
        let readme = std::fs::read_to_string(root().join("crates/inference/README.md")).unwrap();
        let counts = golden().unwrap();
        for figure in [
            format!("{} bytes of RAM", counts.pair_ram_bytes),
            format!("{} bytes of flash", counts.smallest_flash_bytes),
        ] {
            assert!(readme.contains(&figure), "crates/inference/README.md: {figure}");
        }
    }

    #[test]
    fn the_page_of_figures_shows_the_golden_counts() {
        let counts = golden().unwrap();
        TABLES.check(&render(&counts)).unwrap();
        let used = [counts.reference_window, counts.reference_reuse, counts.reference_stream];
        assert!(used.iter().zip(BUDGETS).all(|(&used, budget)| used <= budget), "{used:?}");
        assert!(counts.estimator_tick_max.max(counts.disturbed_tick_max) <= TICK_BUDGET);
    }

    /// Checks every kernel but the filter, which does more while the journal touches the bearing.
    #[test]
    fn the_counts_of_the_networks_do_not_depend_on_the_data() {
        let figures = golden().unwrap().figures;
        let depends =
            |(name, count): &(&String, &Figure)| !name.starts_with("filter") && count.min != count.max;
        let dependent: Vec<_> = figures.iter().filter(depends).collect();
        assert!(dependent.is_empty(), "{dependent:?}");
    }
}
