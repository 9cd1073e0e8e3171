//! Golden cycles, their budgets, and their copy in `docs/firmware.md`.
//!
//! Instructions and the cycles of a Cortex-M4 without wait states are exact for the pinned
//! compiler. Other cycles may differ by [`MAX_DIFFERENCE`]: names of symbols contain a hash of the
//! checkout's path, their order decides where code and constants lie, and that place decides which
//! lines of the flash are read twice. With another compiler only the budgets are compared.

use super::measure;
use super::placement::Placement;
use super::report::{Cycles, Report};
use super::work::Work;
use crate::document::Block;
use crate::golden::Comparison;
use crate::run::{ChoreError, root, write_atomically};
use crate::setup::{TARGET, Toolchain, target};
use std::path::PathBuf;

/// File with the golden figures.
const FILE: &str = "tests/golden/cycles.json";
/// Place of the table.
const TABLE: Block = Block { file: "docs/firmware.md", name: "cycles" };

/// Budgets: upper bounds of the cycles with a placement. A sample period of 100 us has 16,800
/// cycles: the tick does not fit into it.
const BUDGETS: [(Work, Placement, u64); 8] = [
    (Work::Tick, Placement::WeightsInFlash, 34_500),
    (Work::DisturbedTick, Placement::WeightsInFlash, 38_000),
    (Work::Handler, Placement::WeightsInFlash, 26_000),
    (Work::Tick, Placement::WeightsInRam, 31_500),
    (Work::DisturbedTick, Placement::WeightsInRam, 35_000),
    (Work::Handler, Placement::WeightsInRam, 23_000),
    (Work::ReferenceWindow, Placement::NoWaitStates, 310_000),
    (Work::ReferenceStream, Placement::NoWaitStates, 13_000),
];

/// Maximum difference of cycles that depend on the place of code and constants, as a share of the
/// golden ones. Two checkouts of one commit differed by 2.9 % in the reference window with weights
/// in flash, and by 0.4 % at most in the controller's own work.
const MAX_DIFFERENCE: f64 = 0.05;

fn path() -> PathBuf {
    root().join(FILE)
}

/// Returns the first work that exceeds its budget, or that has no figure.
fn over_budget(report: &Report) -> Result<(), ChoreError> {
    for (work, placement, budget) in BUDGETS {
        let found = report.placement(placement.board().0, placement.name());
        let upper = found.and_then(|found| found.cycles.get(work.name())).map_or(0, |cycles| cycles.upper);
        if upper == 0 || upper > budget {
            return Err(ChoreError::Differs {
                what: format!("cycles of {} on {}, {}", work.name(), placement.board().0, placement.name()),
                found: upper.to_string(),
                expected: format!("at most {budget}"),
            });
        }
    }
    Ok(())
}

fn golden() -> Result<Report, ChoreError> {
    let wrong = |found: String| ChoreError::File {
        file: path(),
        found,
        expected: "figures as `cargo xtask bless` writes them",
    };
    let text = std::fs::read_to_string(path()).map_err(|error| wrong(error.to_string()))?;
    serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))
}

/// Compares instructions and cycles without wait states exactly, others up to [`MAX_DIFFERENCE`].
fn is_equal(found: &Report, golden: &Report) -> bool {
    let is_near = |name: &str, (one, other): (u64, u64)| {
        let is_exact = name.contains(Placement::NoWaitStates.name());
        let max = if is_exact { 0.0 } else { MAX_DIFFERENCE };
        one.abs_diff(other) as f64 <= max * other as f64
    };
    let [found_cycles, golden_cycles] = [found, golden].map(|report| report.cycles().collect::<Vec<_>>());
    let names = |cycles: &[(String, Cycles)]| cycles.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
    found.instructions == golden.instructions
        && names(&found_cycles) == names(&golden_cycles)
        && found_cycles.iter().zip(&golden_cycles).all(|((name, one), (_, other))| {
            is_near(name, (one.lower, other.lower)) && is_near(name, (one.upper, other.upper))
        })
}

/// Measures the cycles and writes the golden file and the table.
pub(crate) fn bless() -> Result<(), ChoreError> {
    let report = measure()?;
    over_budget(&report)?;
    let json = serde_json::to_string_pretty(&report).unwrap_or_default() + "\n";
    write_atomically(path(), &json)?;
    TABLE.write(&report.render())
}

/// Measures the cycles and compares them with the budgets and with the golden figures.
pub(crate) fn check() -> Result<Comparison, ChoreError> {
    let found = measure()?;
    over_budget(&found)?;
    if target(TARGET)? == Toolchain::Debian {
        return Ok(Comparison::BudgetsOnly);
    }
    let golden = golden()?;
    if is_equal(&found, &golden) {
        return Ok(Comparison::Complete);
    }
    Err(ChoreError::Differs {
        what: format!("cycles ({FILE}; if the change is intended: cargo xtask bless)"),
        found: serde_json::to_string_pretty(&found).unwrap_or_default(),
        expected: serde_json::to_string_pretty(&golden).unwrap_or_default(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_golden_cycles_are_within_their_budgets_and_on_the_page() {
        let golden = golden().unwrap();
        over_budget(&golden).unwrap();
        TABLE.check(&golden.render()).unwrap();
    }

    #[test]
    fn the_shortest_period_of_own_samples_has_room_for_the_longest_tick_and_a_quarter_of_it() {
        let golden = golden().unwrap();
        for (name, core_hz, shortest_us) in
            [("stm32f405", controller::clock::PLL_HZ, 298), ("nucleo-h743zi2", 480_000_000, 230)]
        {
            let microcontroller = controller::boards::find(name).unwrap().microcontroller;
            let board = golden.boards.iter().find(|board| board.board == microcontroller.feature).unwrap();
            let (tick, handler) = (board.tick_max, microcontroller.handler_cycles.unwrap());
            assert!(5 * tick <= 4 * u64::from(handler), "{name}: {tick} {handler}");
            assert_eq!(microcontroller.shortest_period_us(core_hz), shortest_us, "{name}");
        }
    }

    #[test]
    fn a_figure_over_its_budget_or_without_a_value_is_rejected() {
        for cycles in [0, u64::MAX] {
            let mut report = golden().unwrap();
            for board in &mut report.boards {
                for placement in &mut board.placements {
                    let handler = placement.cycles.get_mut(Work::Handler.name()).unwrap();
                    handler.upper = cycles;
                }
            }
            assert!(over_budget(&report).unwrap_err().to_string().contains("handler"));
        }
    }

    #[test]
    fn cycles_in_flash_may_differ_a_little_and_others_and_instructions_not_at_all() {
        let golden = golden().unwrap();
        let with = |placement: usize, change: fn(&mut Cycles)| {
            let mut report = golden.clone();
            change(report.boards[0].placements[placement].cycles.get_mut(Work::Tick.name()).unwrap());
            report
        };
        assert!(is_equal(&with(0, |_| ()), &golden));
        assert!(is_equal(&with(0, |cycles| cycles.upper += cycles.upper / 25), &golden));
        assert!(!is_equal(&with(0, |cycles| cycles.upper += cycles.upper / 18), &golden));
        assert!(!is_equal(&with(0, |cycles| cycles.lower -= cycles.lower / 18), &golden));
        assert_eq!(golden.boards[0].placements[2].placement, Placement::NoWaitStates.name());
        assert!(!is_equal(&with(2, |cycles| cycles.upper += 1), &golden));
        let mut other = golden.clone();
        *other.instructions.get_mut(Work::Handler.name()).unwrap() += 1;
        assert!(!is_equal(&other, &golden));
        other = golden.clone();
        other.boards.pop();
        assert!(!is_equal(&other, &golden));
    }

    #[test]
    fn lower_bounds_are_below_upper_bounds_and_wait_states_only_add() {
        let golden = golden().unwrap();
        for board in &golden.boards {
            for placement in &board.placements {
                for (work, cycles) in &placement.cycles {
                    assert!(0 < cycles.lower && cycles.lower <= cycles.upper, "{work}: {cycles:?}");
                }
            }
        }
        let upper = |placement: Placement, work: Work| {
            golden.placement(placement.board().0, placement.name()).unwrap().cycles[work.name()].upper
        };
        for work in Work::ALL {
            let [flash, ram, none] =
                [Placement::WeightsInFlash, Placement::WeightsInRam, Placement::NoWaitStates]
                    .map(|placement| upper(placement, work));
            assert!(none < ram && ram <= flash, "{work:?}: {flash} {ram} {none}");
        }
    }
}
