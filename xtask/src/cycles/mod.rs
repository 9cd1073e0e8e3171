//! Cycles of the controller's work, from traces of the emulator and documented timings.
//!
//! A plugin of the emulator records every executed instruction and every data address ([`trace`]).
//! Two models of cores price the records: [`m4`] with the STM32F405's memories ([`flash`]), and
//! [`m7`] roughly. Each gives two bounds, because timings are documented as ranges and because a
//! trace holds neither operands nor the state of a pipeline. Nothing here has been compared with
//! this project's own code on silicon.

mod decode;
mod flash;
mod golden;
mod m4;
mod m7;
mod record;
mod report;
mod trace;

use crate::run::ChoreError;
use controller::clock::PLL_HZ;
use flash::Memory;
pub(crate) use golden::{bless, check};
use m4::CortexM4;
use m7::CortexM7;
use record::{Runs, Work};
use report::{BoardCycles, Cycles, PlacementCycles, Report};
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use trace::Section;

/// Period of 10 kHz, us.
const PERIOD_US: u64 = 100;

/// End of a range of documented timings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Bound {
    /// The fastest case.
    Lower,
    /// The slowest case.
    Upper,
}

impl Bound {
    const ALL: [Self; 2] = [Self::Lower, Self::Upper];

    const fn pick(self, lower: u64, upper: u64) -> u64 {
        match self {
            Self::Lower => lower,
            Self::Upper => upper,
        }
    }
}

/// Board and the places of code and data on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Placement {
    /// STM32F405 at 168 MHz as shipped: code, constants and weights in flash.
    WeightsInFlash,
    /// The same with the weights in RAM or in core-coupled memory.
    WeightsInRam,
    /// The same without any wait state: the limit of every placement.
    NoWaitStates,
    /// STM32H743 at 480 MHz: code in the instruction TCM, data in the data TCM. There is no port.
    TightlyCoupled,
}

impl Placement {
    const ALL: [Self; 4] =
        [Self::WeightsInFlash, Self::WeightsInRam, Self::NoWaitStates, Self::TightlyCoupled];

    const fn name(self) -> &'static str {
        match self {
            Self::WeightsInFlash => "weights in flash, as shipped",
            Self::WeightsInRam => "weights in RAM",
            Self::NoWaitStates => "no wait states",
            Self::TightlyCoupled => "tightly coupled memories, no port yet",
        }
    }

    /// Returns the board, its core and its frequency.
    const fn board(self) -> (&'static str, &'static str, u32) {
        match self {
            Self::TightlyCoupled => ("stm32h743", "Cortex-M7", 480_000_000),
            _ => ("stm32f405", "Cortex-M4", PLL_HZ),
        }
    }

    /// Creates the model of the core; `weights` are their addresses in the traced image.
    fn pricer(self, bound: Bound, weights: &Range<u32>) -> Pricer {
        /// Wait states of the flash at 168 MHz and 3.3 V.
        const WAIT_STATES: u64 = 5;
        let memory =
            |wait_states, is_in_flash| Memory::new(wait_states, bound, Some((weights.clone(), is_in_flash)));
        match self {
            Self::WeightsInFlash => Pricer::M4(CortexM4::new(bound, memory(WAIT_STATES, true))),
            Self::WeightsInRam => Pricer::M4(CortexM4::new(bound, memory(WAIT_STATES, false))),
            Self::NoWaitStates => Pricer::M4(CortexM4::new(bound, memory(0, false))),
            Self::TightlyCoupled => Pricer::M7(CortexM7::new(bound)),
        }
    }
}

/// Model of a core.
enum Pricer {
    M4(CortexM4),
    M7(CortexM7),
}

impl Pricer {
    fn price(&mut self, section: &Section) -> u64 {
        match self {
            Self::M4(core) => core.price(section),
            Self::M7(core) => core.price(section),
        }
    }
}

/// Maxima over the sections of each work: instructions, and cycles by placement.
struct Maxima {
    pricers: Vec<(Placement, Bound, Pricer)>,
    instructions: BTreeMap<Work, u64>,
    cycles: BTreeMap<(Work, usize), Cycles>,
}

impl Maxima {
    fn new() -> Self {
        Self { pricers: vec![], instructions: BTreeMap::new(), cycles: BTreeMap::new() }
    }

    /// Prepares the models for an image with its weights at these addresses.
    fn set_weights(&mut self, weights: &Range<u32>) {
        let bounds = |placement: Placement| {
            Bound::ALL.map(|bound| (placement, bound, placement.pricer(bound, weights)))
        };
        self.pricers = Placement::ALL.into_iter().flat_map(bounds).collect();
    }

    /// Prices a section.
    fn add(&mut self, work: Work, section: &Section) {
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
    fn report(&self) -> Result<Report, ChoreError> {
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

/// Traces and prices everything.
fn measure() -> Result<Report, ChoreError> {
    let mut maxima = Maxima::new();
    let runs = Runs::prepare()?;
    runs.controller(&mut maxima)?;
    runs.counting(&mut maxima)?;
    maxima.report()
}

/// Measures and prints the cycles.
pub(crate) fn cycles(json: bool) -> Result<(), ChoreError> {
    let report = measure()?;
    if json {
        println!("{}", serde_json::json!(report));
    } else {
        print!("{}", report.render());
    }
    Ok(())
}

/// Error for a work without a section in the trace.
fn not_seen(work: &str) -> ChoreError {
    ChoreError::Differs {
        what: format!("trace of {work}"),
        found: "no section".into(),
        expected: "two reads of SysTick's counter around it".into(),
    }
}

/// Prices an image that reads SysTick's counter before and after its work, and prints the cycles.
pub(crate) fn image(elf: &Path) -> Result<(), ChoreError> {
    let mut maxima = Maxima::new();
    Runs::prepare()?.image(elf, &mut maxima)?;
    let instructions = maxima.instructions.get(&Work::Image).ok_or_else(|| not_seen("the image"))?;
    println!("{instructions} instructions");
    for placement in Placement::ALL {
        let key = (Work::Image, placement as usize);
        let Cycles { lower, upper } = maxima.cycles.get(&key).copied().unwrap_or_default();
        println!("{}, {}: {lower}-{upper} cycles", placement.board().0, placement.name());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::decode::Instruction;
    use super::trace::{Access, Section};

    /// Part of a hand-written section. The numbers after the opcode are the words that the
    /// instruction loads or, below 0, stores.
    #[derive(Clone, Copy)]
    pub(super) enum Code {
        /// Narrow instruction.
        Narrow(u16, i32),
        /// Wide instruction.
        Wide(u16, u16, i32),
        /// The instruction before jumps far away.
        Jump,
        /// The instruction before jumps back by this number of bytes.
        Back(u32),
    }

    /// Returns a section that executes this code from 0x0800_0000 on, with data in RAM.
    pub(super) fn section(code: &[Code]) -> Section {
        let (mut section, mut address) = (Section::default(), 0x0800_0000);
        for part in code {
            let (instruction, words) = match *part {
                Code::Narrow(first, words) => (Instruction::decode(first, 0), words),
                Code::Wide(first, second, words) => (Instruction::decode(first, second), words),
                Code::Jump => {
                    address += 0x100;
                    continue;
                }
                Code::Back(bytes) => {
                    address -= bytes;
                    continue;
                }
            };
            section.push(address, instruction);
            for word in 0..words.unsigned_abs() {
                section.push_access(Access {
                    address: 0x2000_0000 + 4 * word,
                    bytes: 4,
                    is_store: words < 0,
                });
            }
            address += u32::from(instruction.bytes);
        }
        section
    }
}
