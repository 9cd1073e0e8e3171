//! Sizes of the firmware image, compared with budgets and with golden figures.
//!
//! All figures must be equal. With a compiler other than the pinned one, only the budgets are
//! compared. The golden file has the default board's image, and that of a board that no emulator
//! models.

use crate::document::Block;
use crate::firmware::{DEFAULT, NOT_EMULATED, OTHER_CORE};
use crate::golden::Comparison;
use crate::run::{ChoreError, root, write_atomically};
use crate::setup::{TARGET, Toolchain, target};
use crate::size::{Figures, Sizes, measure};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// File with the golden figures.
const FILE: &str = "tests/golden/firmware.json";
/// Place of the table.
const TABLE: Block = Block { file: "docs/figures.md", name: "sizes" };
/// Flash budget in bytes: the sectors below those that are written at run time.
const MAX_FLASH: u64 = 512 * 1024;
/// RAM budget in bytes: static memory beside the stack's reserve.
const MAX_RAM: u64 = 80 * 1024;

/// Content of the golden file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Golden {
    /// Figures of the default board's image.
    #[serde(flatten)]
    default: Figures,
    /// Figures of images that are never run, by board.
    not_emulated: BTreeMap<String, Figures>,
}

impl Golden {
    /// Builds and measures the images, and compares them with the budgets.
    fn measure() -> Result<Self, ChoreError> {
        let default = measure(DEFAULT)?;
        let not_emulated = BTreeMap::from([(NOT_EMULATED.0.name.to_owned(), measure(NOT_EMULATED)?)]);
        let golden = Self { default, not_emulated };
        golden.within_budgets()?;
        Ok(golden)
    }

    fn boards(&self) -> impl Iterator<Item = (&str, &Figures)> {
        let not_emulated = self.not_emulated.iter().map(|(name, figures)| (name.as_str(), figures));
        std::iter::once((DEFAULT.0.name, &self.default)).chain(not_emulated)
    }

    fn within_budgets(&self) -> Result<(), ChoreError> {
        self.boards().try_for_each(|(board, figures)| within_budgets(board, &figures.sizes))
    }

    /// Returns the figures as a Markdown table.
    fn render(&self) -> String {
        let head = "| board | flash, bytes | static RAM, bytes | stack, bound and deepest use seen, bytes \
                    | reachable panic |\n|---|---|---|---|---|\n";
        let rows = self.boards().map(|(board, figures)| {
            let Sizes { flash_bytes, ram_bytes, panic_symbol } = &figures.sizes;
            let seen = figures.stack_painted_bytes.map_or("not run".into(), |bytes| bytes.to_string());
            let bound = figures.stack_bound_bytes;
            let panic = if *panic_symbol { "yes" } else { "none" };
            format!("| `{board}` | {flash_bytes} | {ram_bytes} | {bound} and {seen} | {panic} |\n")
        });
        head.to_owned() + &rows.collect::<String>()
    }
}

fn path() -> PathBuf {
    root().join(FILE)
}

/// Rejects an image that exceeds a budget or can panic.
fn within_budgets(board: &str, sizes: &Sizes) -> Result<(), ChoreError> {
    if sizes.flash_bytes <= MAX_FLASH && sizes.ram_bytes <= MAX_RAM && !sizes.panic_symbol {
        return Ok(());
    }
    Err(ChoreError::Differs {
        what: format!("the image for {board}"),
        found: serde_json::to_string_pretty(sizes).unwrap_or_default(),
        expected: format!("at most {MAX_FLASH} bytes of flash, {MAX_RAM} bytes of RAM, no reachable panic"),
    })
}

/// Measures the images and writes the golden figures.
pub(crate) fn bless() -> Result<(), ChoreError> {
    let golden = Golden::measure()?;
    let json = serde_json::to_string_pretty(&golden).unwrap_or_default() + "\n";
    write_atomically(path(), &json)?;
    TABLE.write(&golden.render())
}

/// Measures the images and compares them with the budgets and the golden figures; then builds the
/// image of the other core.
pub(crate) fn check() -> Result<Comparison, ChoreError> {
    let found = Golden::measure()?;
    within_budgets(OTHER_CORE.0.name, &Sizes::read(&OTHER_CORE.build()?)?)?;
    if target(TARGET)? == Toolchain::Debian {
        return Ok(Comparison::BudgetsOnly);
    }
    let wrong = |found: String| ChoreError::File {
        file: path(),
        found,
        expected: "figures as `cargo xtask bless` writes them",
    };
    let golden = std::fs::read_to_string(path()).map_err(|error| wrong(error.to_string()))?;
    let golden: Golden = serde_json::from_str(&golden).map_err(|error| wrong(error.to_string()))?;
    if found == golden {
        return Ok(Comparison::Complete);
    }
    Err(ChoreError::Differs {
        what: format!("figures of the firmware ({FILE}; if the change is intended: cargo xtask bless)"),
        found: serde_json::to_string_pretty(&found).unwrap_or_default(),
        expected: serde_json::to_string_pretty(&golden).unwrap_or_default(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIGURES: Figures = Figures {
        sizes: Sizes { flash_bytes: 90_000, ram_bytes: 9_000, panic_symbol: false },
        stack_bound_bytes: 10_000,
        stack_painted_bytes: Some(8_000),
    };

    #[test]
    fn a_reachable_panic_or_an_exceeded_budget_is_rejected() {
        assert!(within_budgets("any", &FIGURES.sizes).is_ok());
        for sizes in [
            Sizes { panic_symbol: true, ..FIGURES.sizes.clone() },
            Sizes { ram_bytes: MAX_RAM + 1, ..FIGURES.sizes.clone() },
            Sizes { flash_bytes: MAX_FLASH + 1, ..FIGURES.sizes.clone() },
        ] {
            assert!(within_budgets("any", &sizes).is_err());
        }
    }

    #[test]
    fn the_golden_figures_are_within_the_budgets_and_on_the_page() {
        let golden: Golden = serde_json::from_str(&std::fs::read_to_string(path()).unwrap()).unwrap();
        golden.within_budgets().unwrap();
        TABLE.check(&golden.render()).unwrap();
        for (board, figures) in golden.boards() {
            let seen = figures.stack_painted_bytes;
            assert!(seen.unwrap_or_default() <= figures.stack_bound_bytes, "{board}");
            assert!(figures.stack_bound_bytes <= 64 * 1024, "{board}");
            assert_eq!(seen.is_some(), board == DEFAULT.0.name);
        }
    }
}
