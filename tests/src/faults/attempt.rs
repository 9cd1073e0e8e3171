//! One fault carried out on one emulator of its own.
//!
//! The controller is configured and fed up to the sample before the fault, then asked who it is. The framing of that answer is a place in its code that
//! no sample passes, so a breakpoint there stops it exactly there; it is the same instruction at every run. A fault inside a tick takes a
//! second breakpoint from there on. Faults of frames and samples need no debugger.

use super::CampaignError;
use super::emulator::{Emulator, Pumped, Said};
use super::gdb::Gdb;
use super::image::Image;
use super::judge::{self, Outcome};
use super::plan::{Action, Fault};
use super::stage::Stage;
use super::streams::{bytes, disturbed, framed};
use super::trace::Step;
use link::{Command, NumberedCommand, ReportKind, SensorFrame, ToController, ToHost};
use std::path::Path;
use std::time::Duration;

/// Bound on the emulator's start, and on its silence later: the host's own for an answer.
pub const BOUND: Duration = Duration::from_secs(5);
/// Answers before the one at which the core is stopped: its greeting and that to its configuration.
const ANSWERS_BEFORE: u32 = 2;
/// Number of the last command of an attempt.
const LAST: u32 = 4;

/// A controller that stands before a sample.
#[derive(Debug)]
pub struct Prepared {
    /// Its emulator.
    pub emulator: Emulator,
}

impl Prepared {
    /// Starts an image, feeds it and stops it before a sample; the samples behind are queued.
    pub fn start(
        elf: &Path,
        image: &Image,
        stage: &Stage,
        frames: &[SensorFrame],
        sample: usize,
    ) -> Result<Self, CampaignError> {
        let mut emulator = Emulator::start(elf, true, &[])?;
        emulator.gdb()?.set_breakpoint(image.answering)?;
        emulator.gdb()?.go_on()?;
        emulator.send(&configure(stage)?);
        let frames = frames.iter().map(|frame| bytes(&ToController::Sensor(*frame, Default::default())));
        let frames = frames.collect::<Result<Vec<_>, _>>()?;
        let (before, behind) = frames.split_at_checked(sample).unwrap_or_default();
        emulator.send(before.concat().as_slice());
        emulator.send(&bytes(&ToController::Identify { token: 1 })?);
        emulator.send(behind.concat().as_slice());
        emulator.send(&ending(stage)?);
        for answer in 0..=ANSWERS_BEFORE {
            match emulator.pump(2 * BOUND, |_| false)? {
                Pumped::Stopped if answer < ANSWERS_BEFORE => go_past(emulator.gdb()?)?,
                Pumped::Stopped => emulator.gdb()?.clear_breakpoint(image.answering)?,
                other => {
                    return Err(CampaignError::Unexpected {
                        found: format!("{other:?} after {} messages", emulator.said.len()),
                        expected: "a controller that answers",
                    });
                }
            }
        }
        Ok(Self { emulator })
    }
}

/// Carries a fault out and classes it.
pub fn attempt(elf: &Path, image: &Image, stage: &Stage, fault: &Fault) -> Result<Outcome, CampaignError> {
    if fault.action == Action::Stream {
        let samples = disturbed(fault, &stage.frames);
        let mut emulator = Emulator::start(elf, false, &[])?;
        emulator.send(&configure(stage)?);
        emulator.send(framed(fault, &samples)?.concat().as_slice());
        emulator.send(&ending(stage)?);
        let pumped = emulator.pump(BOUND, ended)?;
        return Ok(judge::judge(fault, stage, &emulator.said, pumped));
    }
    let Prepared { mut emulator } = Prepared::start(elf, image, stage, &stage.frames, fault.sample)?;
    let mut fault = fault.clone();
    match fault.action {
        Action::Flip { address, bit, during: None } => emulator.gdb()?.flip(address, bit)?,
        Action::Flip { address, bit, during: Some(step) } => {
            if !reach(&mut emulator, step)? {
                return Ok(judge::not_struck(&fault));
            }
            // The instruction may not be one of every sample's.
            let estimates = emulator.said.iter().filter(|said| matches!(said, Ok(ToHost::Estimate(_))));
            fault.sample = estimates.count();
            emulator.gdb()?.flip(address, bit)?;
        }
        _ => emulator.gdb()?.reset()?,
    }
    emulator.gdb()?.go_on()?;
    let pumped = emulator.pump(BOUND, ended)?;
    Ok(judge::judge(&fault, stage, &emulator.said, pumped))
}

/// Lets the core run to an instruction; whether it comes there before the samples end.
fn reach(emulator: &mut Emulator, step: Step) -> Result<bool, CampaignError> {
    if emulator.gdb()?.register(15)? == step.address && step.before == 0 {
        return Ok(true);
    }
    let gdb = emulator.gdb()?;
    // The place where the core stands is the first of the trace.
    let mut left = step.before + u32::from(gdb.register(15)? != step.address);
    gdb.set_breakpoint(step.address)?;
    while left > 0 {
        go_past(emulator.gdb()?)?;
        match emulator.pump(BOUND, ended)? {
            Pumped::Stopped => left -= 1,
            Pumped::Come => return Ok(false),
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

/// Goes on from a place that may have a breakpoint: the stub would stop there again.
fn go_past(gdb: &mut Gdb) -> Result<(), CampaignError> {
    gdb.step()?;
    gdb.go_on()
}

/// Whether the answer to the last command has come.
fn ended(said: &[Said]) -> bool {
    matches!(said.last(), Some(Ok(ToHost::Acknowledged(acknowledgement))) if acknowledgement.id == LAST)
}

/// What the controller is told before the first sample, and what it is asked behind the last one.
#[must_use]
pub fn messages(stage: &Stage) -> (ToController, [ToController; 3]) {
    let command = |id, command| ToController::Command(NumberedCommand { id, command });
    let ending = [
        command(2, Command::GetReport(ReportKind::Track)),
        command(3, Command::GetReport(ReportKind::Sensors)),
        command(LAST, Command::GetCounters),
    ];
    (command(1, Command::Configure(stage.configuration)), ending)
}

fn configure(stage: &Stage) -> Result<Vec<u8>, CampaignError> {
    bytes(&messages(stage).0)
}

fn ending(stage: &Stage) -> Result<Vec<u8>, CampaignError> {
    Ok(messages(stage).1.iter().map(bytes).collect::<Result<Vec<_>, _>>()?.concat())
}
