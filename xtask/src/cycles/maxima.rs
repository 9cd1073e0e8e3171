//! Maxima of the cycles over all sections of each work.

use super::bound::Bound;
use super::m4::CortexM4;
use super::placement::{Placement, Pricer};
use super::report::{BoardCycles, Cycles, PlacementCycles, Report};
use super::trace::Section;
use super::work::Work;
use crate::run::ChoreError;
use std::collections::BTreeMap;
use std::ops::Range;

/// Period of 10 kHz, us.
const PERIOD_US: u64 = 100;

/// Maxima over the sections of each work: instructions, and cycles by placement.
pub(super) struct Maxima {
    pricers: Vec<(Placement, Bound, Pricer)>,
    pub(super) instructions: BTreeMap<Work, u64>,
    pub(super) cycles: BTreeMap<(Work, usize), Cycles>,
}

impl Maxima {
    pub(super) fn new() -> Self {
        Self { pricers: vec![], instructions: BTreeMap::new(), cycles: BTreeMap::new() }
    }

    /// Prepares the models for an image with its weights at these addresses.
    pub(super) fn set_weights(&mut self, weights: &Range<u32>) {
        let bounds = |placement: Placement| {
            Bound::ALL.map(|bound| (placement, bound, placement.pricer(bound, weights)))
        };
        self.pricers = Placement::ALL.into_iter().flat_map(bounds).collect();
    }

    /// Prices a section.
    pub(super) fn add(&mut self, work: Work, section: &Section) {
        let instructions = self.instructions.entry(work).or_default();
        *instructions = (*instructions).max(section.steps.len() as u64);
        for (placement, bound, pricer) in &mut self.pricers {
            // Arm publishes no entry for the Cortex-M7: that of the Cortex-M4 stands for both.
            let around = if work == Work::Handler { CortexM4::interrupt(*bound) } else { 0 };
            let cycles = pricer.price(section) + around;
            let max = self.cycles.entry((work, *placement as usize)).or_default();
            match bound {
                Bound::Lower => max.lower = max.lower.max(cycles),
                Bound::Upper => max.upper = max.upper.max(cycles),
            }
        }
    }

    /// Returns the figures; a work that was not seen is an error.
    pub(super) fn report(&self) -> Result<Report, ChoreError> {
        if let Some(work) = Work::ALL.into_iter().find(|work| !self.instructions.contains_key(work)) {
            return Err(not_seen(work.name()));
        }
        let mut boards: Vec<BoardCycles> = vec![];
        for placement in Placement::ALL {
            let of_work = |work: Work| {
                let cycles = self.cycles.get(&(work, placement as usize)).copied().unwrap_or_default();
                (work.name().to_owned(), cycles)
            };
            let cycles: BTreeMap<_, _> = Work::ALL.into_iter().map(of_work).collect();
            let name = placement.board().0;
            if boards.last().is_none_or(|board| board.board != name) {
                boards.push(board(placement, &cycles));
            }
            if let Some(board) = boards.last_mut() {
                board.placements.push(PlacementCycles { placement: placement.name().into(), cycles });
            }
        }
        let instructions = self.instructions.iter().map(|(work, &count)| (work.name().to_owned(), count));
        Ok(Report { instructions: instructions.collect(), boards })
    }
}

/// Returns the figures of a board from those of its first placement.
fn board(placement: Placement, cycles: &BTreeMap<String, Cycles>) -> BoardCycles {
    let (board, core, core_hz) = placement.board();
    let upper = |work: Work| cycles.get(work.name()).map_or(0, |cycles| cycles.upper);
    BoardCycles {
        board: board.into(),
        core: core.into(),
        core_hz,
        period_cycles: u64::from(core_hz) * PERIOD_US / 1_000_000,
        tick_max: upper(Work::Tick).max(upper(Work::DisturbedTick)),
        handler_max: upper(Work::Handler),
        reference_window: upper(Work::ReferenceWindow),
        reference_stream: upper(Work::ReferenceStream),
        placements: vec![],
    }
}

/// Error for a work without a section in the trace.
pub(super) fn not_seen(work: &str) -> ChoreError {
    ChoreError::Differs {
        what: format!("trace of {work}"),
        found: "no section".into(),
        expected: "two reads of SysTick's counter around it".into(),
    }
}
