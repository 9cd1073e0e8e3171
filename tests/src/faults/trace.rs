//! Instructions that the core executes for one sample: program counter and stack pointer.
//!
//! Single steps from the framing of a reply to the estimate of the next sample. The control flow of
//! a tick does not depend on data, so one trace represents all samples.

use super::CampaignError;
use super::attempt::Prepared;
use super::emulator::Received;
use super::image::Image;
use super::plan::Step;
use super::scenario::{FAULTS_FROM, Scenario};
use link::ToHost;
use std::path::Path;

/// Maximum number of instructions in one pass of the link's loop.
const MAX_STEPS: usize = 40_000;
/// Steps between two reads of the link.
const STEPS_PER_PUMP: usize = 64;

/// Traces one sample.
pub fn trace(elf: &Path, image: &Image, scenario: &Scenario) -> Result<Vec<Step>, CampaignError> {
    let mut prepared = Prepared::start(elf, image, scenario, &scenario.frames, FAULTS_FROM)?;
    let emulator = &mut prepared.emulator;
    let mut counts = std::collections::HashMap::new();
    let mut steps = vec![];
    while steps.len() < MAX_STEPS {
        for _ in 0..STEPS_PER_PUMP {
            let gdb = emulator.gdb()?;
            let (address, stack) = (gdb.register(15)?, gdb.register(13)?);
            let count = counts.entry(address).or_insert(0);
            steps.push(Step { address, stack, before: *count });
            *count += 1;
            gdb.step()?;
        }
        emulator.pump(std::time::Duration::ZERO, |_| true)?;
        let is_finished = emulator.received.iter().any(is_first_estimate);
        if is_finished {
            return Ok(steps);
        }
    }
    Err(CampaignError::Unexpected {
        found: format!("no estimate within {MAX_STEPS} instructions"),
        expected: "one for every sample",
    })
}

/// Returns whether a message is the estimate of the first sample after the stop.
fn is_first_estimate(message: &Received) -> bool {
    matches!(message, Ok(ToHost::Estimate(e)) if e.estimate.sequence as usize == FAULTS_FROM)
}
