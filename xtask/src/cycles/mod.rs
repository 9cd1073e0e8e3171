//! Cycles of the controller's work, from traces of the emulator and documented timings.
//!
//! A plugin of the emulator records every executed instruction and every data address ([`trace`]).
//! Two models of cores price the records: [`m4`] with the STM32F405's memories ([`flash`]), and
//! [`m7`] roughly. The images are those of the STM32F405: no emulator models an STM32H743. Each
//! gives two bounds, because timings are documented as ranges and because a trace holds neither
//! operands nor the state of a pipeline. Nothing here has been compared with this project's own
//! code on silicon.

mod bound;
mod decode;
mod flash;
mod golden;
mod m4;
mod m7;
mod m7_caches;
mod maxima;
mod placement;
mod record;
mod report;
mod trace;
mod work;

use crate::run::ChoreError;
pub(crate) use golden::{bless, check};
use maxima::{Maxima, not_seen};
use placement::Placement;
use record::Runs;
use report::{Cycles, Report};
use std::path::Path;
use work::Work;

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
