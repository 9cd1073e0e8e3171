//! Cycles as data and as a table.

use super::work::Work;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt::Write;

/// Maximum cycles over all priced samples, with the fastest and the slowest documented timings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Cycles {
    pub(super) lower: u64,
    pub(super) upper: u64,
}

/// Cycles with one placement of code and data.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct PlacementCycles {
    /// Description of the placement.
    pub(super) placement: String,
    /// Cycles by work.
    #[serde(flatten)]
    pub(super) cycles: BTreeMap<String, Cycles>,
}

/// Cycles on one board. The figures of the board itself are the upper bounds of its first
/// placement.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct BoardCycles {
    pub(super) board: String,
    pub(super) core: String,
    pub(super) core_hz: u32,
    /// Cycles of a sample period.
    pub(super) period_cycles: u64,
    /// Tick in lockstep over nominal and disturbed samples.
    pub(super) tick_max: u64,
    /// Handler of the timer's interrupt with own samples, without the clocks of the sensor bus.
    pub(super) handler_max: u64,
    pub(super) reference_window: u64,
    pub(super) reference_stream: u64,
    /// All placements.
    pub(super) placements: Vec<PlacementCycles>,
}

/// All figures.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Report {
    /// Maximum instructions by work, as the trace counts them.
    pub(super) instructions: BTreeMap<String, u64>,
    /// Boards with a model of their core.
    pub(super) boards: Vec<BoardCycles>,
}

/// Works of the table with their descriptions.
const ROWS: [(Work, &str); 7] = [
    (Work::Tick, "tick in lockstep, bench B"),
    (Work::DisturbedTick, "the same over disturbed samples"),
    (Work::Handler, "handler of the timer, own samples"),
    (Work::ReferenceWindow, "reference network, window"),
    (Work::ReferenceStream, "reference network, column"),
    (Work::Filter, "Kalman filter, sample"),
    (Work::FilterDriveForce, "the same with drive force"),
];

impl Report {
    /// Returns the table: works in rows, placements in columns.
    pub(super) fn render(&self) -> String {
        let placements = || {
            self.boards
                .iter()
                .flat_map(|board| board.placements.iter().map(move |placement| (board, placement)))
        };
        let mut text = "| maximum cycles | instructions |".to_owned();
        for (board, placement) in placements() {
            let mhz = board.core_hz / 1_000_000;
            // Writing to a string does not fail.
            let _ = write!(text, " {} at {mhz} MHz, {} |", board.board, placement.placement);
        }
        text += "\n|---|---|";
        text += &"---|".repeat(placements().count());
        for (work, name) in ROWS {
            let instructions = self.instructions.get(work.name()).copied().unwrap_or_default();
            let _ = write!(text, "\n| {name} | {instructions} |");
            for (board, placement) in placements() {
                let Cycles { lower, upper } = placement.cycles.get(work.name()).copied().unwrap_or_default();
                let _ = write!(text, " {lower}-{upper}{} |", share(work, upper, board.period_cycles));
            }
        }
        text + "\n"
    }

    /// Returns all cycles with the names of their board, placement and work.
    pub(super) fn cycles(&self) -> impl Iterator<Item = (String, Cycles)> {
        self.boards.iter().flat_map(|board| {
            board.placements.iter().flat_map(move |placement| {
                let name = move |work: &str| format!("{}, {}: {work}", board.board, placement.placement);
                placement.cycles.iter().map(move |(work, &cycles)| (name(work), cycles))
            })
        })
    }

    /// Returns the figures of a board's placement.
    pub(super) fn placement(&self, board: &str, placement: &str) -> Option<&PlacementCycles> {
        let board = self.boards.iter().find(|found| found.board == board)?;
        board.placements.iter().find(|found| found.placement == placement)
    }
}

/// Returns the share of a sample period for work that has to end within it.
fn share(work: Work, upper: u64, period: u64) -> String {
    match work {
        Work::Tick | Work::DisturbedTick | Work::Handler => {
            format!(", {:.0} %", 100.0 * upper as f64 / period.max(1) as f64)
        }
        _ => String::new(),
    }
}
