//! What the core carries out for one sample: program counter and stack pointer, instruction by instruction.
//!
//! Single steps from the framing of an answer to the estimate of the sample behind it. The control flow of a tick does not depend on data, so it
//! stands for every sample.

use super::CampaignError;
use super::attempt::Prepared;
use super::image::Image;
use super::stage::{FAULTS_FROM, Stage};
use link::ToHost;
use std::path::Path;

/// Most instructions of a round of the link's loop: more is no trace of one.
const LONGEST: usize = 40_000;
/// Steps between two looks at what was said.
const LOOK: usize = 64;

/// An instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    /// Its address.
    pub address: u32,
    /// The stack pointer before it.
    pub stack: u32,
    /// How often the address had come before in this trace.
    pub before: u32,
}

/// Traces one sample.
pub fn trace(elf: &Path, image: &Image, stage: &Stage) -> Result<Vec<Step>, CampaignError> {
    let mut prepared = Prepared::start(elf, image, stage, &stage.frames, FAULTS_FROM)?;
    let emulator = &mut prepared.emulator;
    let mut counts = std::collections::HashMap::new();
    let mut steps = vec![];
    while steps.len() < LONGEST {
        for _ in 0..LOOK {
            let gdb = emulator.gdb()?;
            let (address, stack) = (gdb.register(15)?, gdb.register(13)?);
            let count = counts.entry(address).or_insert(0);
            steps.push(Step { address, stack, before: *count });
            *count += 1;
            gdb.step()?;
        }
        emulator.pump(std::time::Duration::ZERO, |_| true)?;
        let told = emulator.said.iter().any(
            |said| matches!(said, Ok(ToHost::Estimate(e)) if e.estimate.sequence as usize == FAULTS_FROM),
        );
        if told {
            return Ok(steps);
        }
    }
    Err(CampaignError::Unexpected {
        found: format!("no estimate within {LONGEST} instructions"),
        expected: "one for every sample",
    })
}
