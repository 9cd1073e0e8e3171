//! What the firmware's image takes, against its budgets and against what is checked in.
//!
//! Flash may differ by the length of the build's name, which is in the image; everything else must be the same number. With another
//! compiler than the pinned one only the budgets hold.

use crate::firmware::{DEFAULT, OTHER_CORE};
use crate::run::{ChoreError, root, write_whole};
use crate::setup::{TARGET, Way, target};
use crate::size::{Figures, Sizes, measure};
use std::path::PathBuf;

/// The file with the figures.
const FILE: &str = "tests/golden/firmware.json";
/// Most flash, bytes: what is left below the sectors that are written at run time.
const MOST_FLASH: u64 = 512 * 1024;
/// Most static RAM, bytes: what is above the stack's room.
const MOST_RAM: u64 = 80 * 1024;
/// Longest name of a build with padding, bytes.
const NAME: u64 = 40;

fn path() -> PathBuf {
    root().join(FILE)
}

/// Refuses an image that no board could run for long.
fn within_budgets(board: &str, sizes: &Sizes) -> Result<(), ChoreError> {
    if sizes.flash_bytes <= MOST_FLASH && sizes.ram_bytes <= MOST_RAM && !sizes.panic_symbol {
        return Ok(());
    }
    Err(ChoreError::Differs {
        what: format!("the image for {board}"),
        found: serde_json::to_string_pretty(sizes).unwrap_or_default(),
        expected: format!("at most {MOST_FLASH} bytes of flash, {MOST_RAM} of RAM, no reachable panic"),
    })
}

fn same(found: &Figures, golden: &Figures) -> bool {
    let flash = found.sizes.flash_bytes.abs_diff(golden.sizes.flash_bytes) <= NAME;
    let sizes = Sizes { flash_bytes: golden.sizes.flash_bytes, ..found.sizes.clone() };
    flash && *golden == Figures { sizes, ..found.clone() }
}

/// Measures anew and writes the figures.
pub(crate) fn bless() -> Result<(), ChoreError> {
    let figures = measure()?;
    within_budgets(DEFAULT.name, &figures.sizes)?;
    let json = serde_json::to_string_pretty(&figures).unwrap_or_default() + "\n";
    write_whole(path(), &json)
}

/// Measures anew and compares with budgets and golden figures; then builds the image of the other core.
pub(crate) fn check() -> Result<(), ChoreError> {
    let found = measure()?;
    within_budgets(DEFAULT.name, &found.sizes)?;
    within_budgets(OTHER_CORE.name, &Sizes::of(&OTHER_CORE.build()?)?)?;
    if target(TARGET)? == Way::Debian {
        return Ok(());
    }
    let wrong = |found: String| ChoreError::File {
        file: path(),
        found,
        expected: "figures as `cargo xtask bless` writes them",
    };
    let golden = std::fs::read_to_string(path()).map_err(|error| wrong(error.to_string()))?;
    let golden: Figures = serde_json::from_str(&golden).map_err(|error| wrong(error.to_string()))?;
    if same(&found, &golden) {
        return Ok(());
    }
    Err(ChoreError::Differs {
        what: format!("figures of the firmware ({FILE}; if the change is meant: cargo xtask bless)"),
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
        stack_painted_bytes: 8_000,
    };

    #[test]
    fn only_the_name_of_the_build_may_make_a_difference() {
        let with = |flash_bytes| Figures { sizes: Sizes { flash_bytes, ..FIGURES.sizes.clone() }, ..FIGURES };
        assert!(same(&with(90_040), &FIGURES) && same(&with(89_960), &FIGURES));
        assert!(!same(&with(90_041), &FIGURES));
        assert!(!same(&Figures { stack_bound_bytes: 10_001, ..FIGURES }, &FIGURES));
        assert!(!same(
            &Figures { sizes: Sizes { ram_bytes: 8_999, ..FIGURES.sizes.clone() }, ..FIGURES },
            &FIGURES
        ));
    }

    #[test]
    fn a_reachable_panic_or_a_full_memory_is_refused() {
        assert!(within_budgets("any", &FIGURES.sizes).is_ok());
        for sizes in [
            Sizes { panic_symbol: true, ..FIGURES.sizes.clone() },
            Sizes { ram_bytes: MOST_RAM + 1, ..FIGURES.sizes.clone() },
            Sizes { flash_bytes: MOST_FLASH + 1, ..FIGURES.sizes.clone() },
        ] {
            assert!(within_budgets("any", &sizes).is_err());
        }
    }

    #[test]
    fn what_is_checked_in_is_within_the_budgets() {
        let golden: Figures = serde_json::from_str(&std::fs::read_to_string(path()).unwrap()).unwrap();
        assert!(within_budgets(DEFAULT.name, &golden.sizes).is_ok());
        assert!(
            golden.stack_painted_bytes <= golden.stack_bound_bytes && golden.stack_bound_bytes <= 64 * 1024
        );
    }
}
