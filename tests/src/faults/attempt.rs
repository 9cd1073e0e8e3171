//! Injection of one fault into a fresh emulator.
//!
//! The controller is configured and gets the samples before the fault, then an identify request.
//! The function that frames the reply is not called for a sample, so a breakpoint there stops the
//! core between two samples, at the same instruction in every run. A fault inside a tick needs a
//! second breakpoint. Faults of frames and samples need no debugger.

use super::CampaignError;
use super::classify::{self, Outcome};
use super::emulator::{Emulator, PumpEnd, Received};
use super::gdb::Gdb;
use super::image::Image;
use super::plan::{Action, Fault, Step};
use super::scenario::Scenario;
use super::streams::{bytes, disturbed, framed};
use link::{Command, NumberedCommand, ReportKind, SensorFrame, ToController, ToHost};
use std::path::Path;
use std::time::Duration;

/// Timeout of the emulator's start and of every later reply; the host's own timeout of a reply.
pub const TIMEOUT: Duration = Duration::from_secs(5);
/// Replies before the one at which the core is stopped: its hello frame and the reply to the
/// configuration.
const ANSWERS_BEFORE: u32 = 2;
/// Maximum number of messages before it; impacts may come between the samples.
const MAX_STOPS: u32 = 20;
/// Identifier of the last command.
const LAST_COMMAND: u32 = 4;

/// A controller that is stopped before a sample.
#[derive(Debug)]
pub(crate) struct Prepared {
    /// The emulator.
    pub emulator: Emulator,
}

impl Prepared {
    /// Starts an image and stops it before a sample; the later samples are queued.
    pub(crate) fn start(
        elf: &Path,
        image: &Image,
        scenario: &Scenario,
        frames: &[SensorFrame],
        sample: usize,
    ) -> Result<Self, CampaignError> {
        let mut emulator = Emulator::start(elf, true, &[])?;
        emulator.gdb()?.set_breakpoint(image.answering)?;
        emulator.gdb()?.resume()?;
        emulator.send(&configure(scenario)?);
        let frames = frames.iter().map(|frame| bytes(&ToController::Sensor(*frame, Default::default())));
        let frames = frames.collect::<Result<Vec<_>, _>>()?;
        let (before, after) = frames.split_at_checked(sample).unwrap_or_default();
        emulator.send(before.concat().as_slice());
        emulator.send(&bytes(&ToController::Identify { token: 1 })?);
        emulator.send(after.concat().as_slice());
        emulator.send(&ending(scenario)?);
        let mut stops = 0;
        loop {
            match emulator.pump(2 * TIMEOUT, |_| false)? {
                PumpEnd::Stopped
                    if stops < ANSWERS_BEFORE
                        || stops < MAX_STOPS && estimates(&emulator.received) < sample =>
                {
                    stops += 1;
                    resume_past(emulator.gdb()?)?;
                }
                PumpEnd::Stopped => {
                    emulator.gdb()?.clear_breakpoint(image.answering)?;
                    break;
                }
                other => {
                    return Err(CampaignError::Unexpected {
                        found: format!("{other:?} after {} messages", emulator.received.len()),
                        expected: "a controller that answers",
                    });
                }
            }
        }
        Ok(Self { emulator })
    }
}

/// Number of received estimates.
fn estimates(received: &[Received]) -> usize {
    received.iter().filter(|message| matches!(message, Ok(ToHost::Estimate(_)))).count()
}

/// Injects a fault and classifies it.
pub fn attempt(
    elf: &Path,
    image: &Image,
    scenario: &Scenario,
    fault: &Fault,
) -> Result<Outcome, CampaignError> {
    if fault.action == Action::Stream {
        let samples = disturbed(fault, &scenario.frames);
        let mut emulator = Emulator::start(elf, false, &[])?;
        emulator.send(&configure(scenario)?);
        emulator.send(framed(fault, &samples)?.concat().as_slice());
        emulator.send(&ending(scenario)?);
        let end = emulator.pump(TIMEOUT, ended)?;
        return Ok(classify::classify(fault, scenario, &emulator.received, end));
    }
    let Prepared { mut emulator } = Prepared::start(elf, image, scenario, &scenario.frames, fault.sample)?;
    let mut fault = fault.clone();
    match fault.action {
        Action::Flip { address, bit, during: None } => emulator.gdb()?.flip(address, bit)?,
        Action::Flip { address, bit, during: Some(step) } => {
            if !reach(&mut emulator, step)? {
                return Ok(classify::not_struck(&fault));
            }
            // Not every sample executes this instruction, so the sample of the flip may be a later
            // one.
            let estimates =
                emulator.received.iter().filter(|received| matches!(received, Ok(ToHost::Estimate(_))));
            fault.sample = estimates.count();
            emulator.gdb()?.flip(address, bit)?;
        }
        _ => emulator.gdb()?.reset()?,
    }
    emulator.gdb()?.resume()?;
    let end = emulator.pump(TIMEOUT, ended)?;
    Ok(classify::classify(&fault, scenario, &emulator.received, end))
}

/// Runs the core to an instruction; returns false if the samples end before it.
fn reach(emulator: &mut Emulator, step: Step) -> Result<bool, CampaignError> {
    if emulator.gdb()?.register(15)? == step.address && step.before == 0 {
        return Ok(true);
    }
    let gdb = emulator.gdb()?;
    // The instruction at which the core is stopped is the first of the trace.
    let mut left = step.before + u32::from(gdb.register(15)? != step.address);
    gdb.set_breakpoint(step.address)?;
    while left > 0 {
        resume_past(emulator.gdb()?)?;
        match emulator.pump(TIMEOUT, ended)? {
            PumpEnd::Stopped => left -= 1,
            PumpEnd::Arrived => return Ok(false),
            other => {
                return Err(CampaignError::Unexpected {
                    found: format!("{other:?} of a controller that nothing has disturbed"),
                    expected: "an answer to the last command",
                });
            }
        }
    }
    emulator.gdb()?.clear_breakpoint(step.address)?;
    Ok(true)
}

/// Resumes from an address that may have a breakpoint: a plain resume would stop there at once.
fn resume_past(gdb: &mut Gdb) -> Result<(), CampaignError> {
    gdb.step()?;
    gdb.resume()
}

/// Returns whether the reply to the last command has arrived.
fn ended(received: &[Received]) -> bool {
    let Some(Ok(ToHost::Acknowledged(last))) = received.last() else { return false };
    last.id == LAST_COMMAND
}

/// Returns the message before the first sample and the messages after the last one.
#[must_use]
pub fn messages(scenario: &Scenario) -> (ToController, [ToController; 3]) {
    let command = |id, command| ToController::Command(NumberedCommand { id, command });
    let ending = [
        command(2, Command::GetReport(ReportKind::Track)),
        command(3, Command::GetReport(ReportKind::Sensors)),
        command(LAST_COMMAND, Command::GetCounters),
    ];
    (command(1, Command::Configure(scenario.configuration)), ending)
}

fn configure(scenario: &Scenario) -> Result<Vec<u8>, CampaignError> {
    bytes(&messages(scenario).0)
}

fn ending(scenario: &Scenario) -> Result<Vec<u8>, CampaignError> {
    Ok(messages(scenario).1.iter().map(bytes).collect::<Result<Vec<_>, _>>()?.concat())
}
