//! Soak test: the emulated controller follows bench B for hours of bench time and must give the
//! same bits as the controller's code in this process.
//!
//! The samples are a run of the bench, read by its sensors: several drive cycles, then the last one
//! repeatedly with fresh noise. Sequence numbers and times start at given values, for example near
//! the end of their 32 bits, and wrap. Samples are written as fast as the controller reads them,
//! and compared in batches. The memory of both processes is read after every batch. Every wait has
//! a timeout.
//!
//! A soak passes if no estimate differs in any bit, no tick takes longer than a sample period, the
//! controller does not restart, every sample has one estimate, and counters and tracked quantities
//! are equal at the end. After a tenth of the samples, the memory of this process may grow by at
//! most [`GROWTH_BYTES`]. The emulator's memory is reported without a limit, because it stores
//! translated code.

use crate::faults::CampaignError;
use crate::faults::attempt::TIMEOUT;
use crate::faults::emulator::{Emulator, PumpEnd};
use crate::faults::image::Image;
use crate::faults::streams::bytes;
use bench::Bench;
use bench::description::TransmissionBench;
use bench::plants::transmission::{Snapshot, Transmission};
use controller::emulator::TICKS_PER_INSTRUCTION;
use controller::flags::CONVERGING;
use host_sim::controller::{Controller, NativeController};
use host_sim::run::configuration::controller_configuration;
use host_sim::run::force::{DEFAULT_STEP_S, ForceSource, SAMPLE_RATE_HZ, run_bench};
use host_sim::run::sensing;
use link::{
    Answer, Command, ContactSource, ControllerConfiguration, NumberedCommand, ReportKind, SensorFrame,
    ToController, ToHost,
};
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::time::Instant;

/// Maximum growth of this process's memory, in bytes.
pub(crate) const GROWTH_BYTES: u64 = 8 << 20;
/// Maximum instructions of a tick.
pub const TICK_INSTRUCTIONS: f64 = 18_500.0;
/// Drive cycles up to the one that is repeated.
const CYCLES: u32 = 3;
/// Samples in a batch; the pipes hold about as many.
const BATCH: usize = 1_000;

/// Length, start and noise of a soak.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// Number of samples.
    pub ticks: u64,
    /// Seed of the sensor noise.
    pub seed: u64,
    /// Sequence number of the first sample.
    pub sequence: u32,
    /// Time of the first sample, us.
    pub time_us: u32,
}

/// Result of a soak.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SoakResult {
    /// Number of samples.
    pub ticks: u64,
    /// Wraps of the sequence number.
    pub sequence_wraps: u32,
    /// Wraps of the time.
    pub time_wraps: u32,
    /// Estimates that differ from the host's in any bit.
    pub bit_differences: u64,
    /// Ticks longer than a sample period.
    pub deadline_misses: u64,
    /// Minimum instructions of a tick.
    pub instructions_per_tick_min: u64,
    /// Maximum instructions of a tick.
    pub instructions_per_tick_max: u64,
    /// Estimates with any flag. "Onset not seen" does not count: bench B starts in contact.
    pub marked: u64,
    /// True if counters and tracked quantities were equal at the end.
    pub same_reports: bool,
    /// Largest growth of this process's memory after a tenth of the samples, bytes.
    pub host_growth_bytes: u64,
    /// Largest growth of the emulator's memory after a tenth of the samples, bytes.
    pub emulator_growth_bytes: u64,
    /// Samples a second of wall time.
    pub ticks_per_s: f64,
}

impl SoakResult {
    /// Returns whether all criteria are met.
    #[must_use]
    pub fn has_passed(&self) -> bool {
        self.bit_differences == 0
            && self.deadline_misses == 0
            && self.same_reports
            && self.host_growth_bytes <= GROWTH_BYTES
    }
}

/// Endless sequence of samples.
struct Samples {
    bench: Bench,
    cycle: Vec<Snapshot>,
    frames: std::vec::IntoIter<SensorFrame>,
    seed: u64,
    sequence: u32,
    time_us: u32,
    period_us: u32,
}

impl Samples {
    fn new(plan: &Plan) -> Result<(ControllerConfiguration, Self), CampaignError> {
        let base = TransmissionBench::open("bench-b").map_err(host_sim::cli::error::CliError::from)?;
        let mut bench = base.resolved();
        bench.drive.cycles = CYCLES;
        let forced = run_bench(&bench, ForceSource::Law, DEFAULT_STEP_S, || {})?;
        let plant = Transmission::new(&bench, bench.drive_profile(), bench.load_profile());
        let configuration = controller_configuration(&plant, &bench, SAMPLE_RATE_HZ, ContactSource::Network)?;
        let cycle_samples = (bench.drive.period_s * SAMPLE_RATE_HZ).round() as usize;
        let run = forced.run.samples;
        let cycle = run.get(run.len().saturating_sub(cycle_samples)..).unwrap_or_default().to_vec();
        let bench = Bench::from(bench);
        // The complete run once, so that the controller sees the journal land.
        let frames = sensing::frames(&bench, &run, plan.seed).into_iter();
        let samples = Self {
            bench,
            cycle,
            frames,
            seed: plan.seed.wrapping_add(1),
            sequence: plan.sequence,
            time_us: plan.time_us,
            period_us: configuration.bench.sample_period_us,
        };
        Ok((configuration, samples))
    }
}

impl Iterator for Samples {
    type Item = SensorFrame;

    fn next(&mut self) -> Option<SensorFrame> {
        let frame = match self.frames.next() {
            Some(frame) => frame,
            None => {
                self.frames = sensing::frames(&self.bench, &self.cycle, self.seed).into_iter();
                self.seed = self.seed.wrapping_add(1);
                self.frames.next()?
            }
        };
        let numbered = SensorFrame { sequence: self.sequence, time_us: self.time_us, ..frame };
        self.sequence = self.sequence.wrapping_add(1);
        self.time_us = self.time_us.wrapping_add(self.period_us);
        Some(numbered)
    }
}

/// Runs a soak; `done` is called with the size of every batch.
pub fn soak(elf: &Path, plan: &Plan, mut done: impl FnMut(u64)) -> Result<SoakResult, CampaignError> {
    // An unusable image would run into a long timeout.
    Image::read(elf)?;
    let (configuration, mut samples) = Samples::new(plan)?;
    let mut native = NativeController::start(configuration)?;
    let mut emulator = Emulator::start(elf, false, &["-no-reboot"])?;
    let mut commands = 0;
    order(&mut emulator, &mut commands, Command::Configure(configuration))?;
    let mut result =
        SoakResult { ticks: plan.ticks, instructions_per_tick_min: u64::MAX, ..SoakResult::default() };
    let (mut left, mut memory, begun) = (plan.ticks, None, Instant::now());
    let mut last = SensorFrame { sequence: plan.sequence, time_us: plan.time_us, ..SensorFrame::default() };
    while left > 0 {
        let batch: Vec<_> = samples.by_ref().take(BATCH.min(left.try_into().unwrap_or(BATCH))).collect();
        emulator.received.clear();
        for frame in &batch {
            emulator.send(&bytes(&ToController::Sensor(*frame, Default::default()))?);
        }
        let is_estimate = |received: &&_| matches!(received, Ok(ToHost::Estimate(_)));
        let end =
            emulator.pump(TIMEOUT, |received| received.iter().filter(is_estimate).count() >= batch.len())?;
        let count = emulator.received.iter().filter(is_estimate).count();
        let estimates = emulator.received.iter().filter_map(|received| match received {
            Ok(ToHost::Estimate(numbered)) => Some(&numbered.estimate),
            _ => None,
        });
        for (frame, estimate) in batch.iter().zip(estimates) {
            result.add(
                native.exchange(frame)?.same_bits(estimate),
                estimate.flags,
                estimate.instruction_ticks,
            );
            result.sequence_wraps += u32::from(frame.sequence < last.sequence);
            result.time_wraps += u32::from(frame.time_us < last.time_us);
            last = *frame;
        }
        let others = emulator.received.iter().find(|received| {
            !matches!(
                received,
                Ok(ToHost::Estimate(_) | ToHost::Slow(_) | ToHost::Impact(_) | ToHost::Block(_))
            )
        });
        if end != PumpEnd::Arrived || count != batch.len() || others.is_some() {
            return Err(CampaignError::Unexpected {
                found: format!(
                    "{end:?} after sample {}, {count} estimates to {} samples, {others:?}",
                    last.sequence,
                    batch.len()
                ),
                expected: "one estimate for every sample and nothing else",
            });
        }
        left -= batch.len() as u64;
        if left <= plan.ticks - plan.ticks / 10 {
            let now = [std::process::id(), emulator.process_id()].map(resident_bytes);
            let [host, other] = *memory.get_or_insert(now);
            result.host_growth_bytes = result.host_growth_bytes.max(now[0].saturating_sub(host));
            result.emulator_growth_bytes = result.emulator_growth_bytes.max(now[1].saturating_sub(other));
        }
        done(batch.len() as u64);
    }
    result.ticks_per_s = plan.ticks as f64 / begun.elapsed().as_secs_f64();
    result.same_reports = true;
    for command in
        [Command::GetReport(ReportKind::Track), Command::GetReport(ReportKind::Sensors), Command::GetCounters]
    {
        let emulated = order(&mut emulator, &mut commands, command)?;
        result.same_reports &= native.order(command)? == emulated;
    }
    Ok(result)
}

impl SoakResult {
    fn add(&mut self, same: bool, flags: u32, timer_ticks: u32) {
        let instructions = f64::from(timer_ticks) / TICKS_PER_INSTRUCTION;
        self.bit_differences += u64::from(!same);
        self.marked += u64::from(flags & !CONVERGING.bits() != 0);
        self.deadline_misses += u64::from(instructions > TICK_INSTRUCTIONS);
        self.instructions_per_tick_max = self.instructions_per_tick_max.max(instructions.round() as u64);
        // The first estimate reports no earlier tick.
        if timer_ticks > 0 {
            self.instructions_per_tick_min = self.instructions_per_tick_min.min(instructions.round() as u64);
        }
    }
}

/// Sends a command to the emulated controller and returns the reply.
fn order(emulator: &mut Emulator, commands: &mut u32, command: Command) -> Result<Answer, CampaignError> {
    *commands += 1;
    let id = *commands;
    emulator.received.clear();
    emulator.send(&bytes(&ToController::Command(NumberedCommand { id, command }))?);
    let answers = |message: &_| matches!(message, Ok(ToHost::Acknowledged(reply)) if reply.id == id);
    emulator.pump(2 * TIMEOUT, |received| received.iter().any(answers))?;
    let answer = emulator.received.iter().find_map(|received| match received {
        Ok(ToHost::Acknowledged(acknowledgement)) if acknowledgement.id == id => acknowledgement.outcome.ok(),
        _ => None,
    });
    answer.ok_or_else(|| CampaignError::Unexpected {
        found: format!("{:?}", emulator.received),
        expected: "a command carried out",
    })
}

/// Returns the resident memory of a process in bytes; 0 if the system does not report it.
fn resident_bytes(process: u32) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    let kibibytes = line.and_then(|line| line.split_whitespace().next()?.parse::<u64>().ok());
    kibibytes.unwrap_or(0) * 1024
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_memory_of_a_process_is_read_and_0_without_one() {
        assert!(resident_bytes(std::process::id()) > 100_000);
        assert_eq!(resident_bytes(u32::MAX), 0);
    }

    #[test]
    fn one_difference_or_a_long_tick_or_growing_memory_fails_the_soak() {
        let passed = SoakResult { same_reports: true, ..SoakResult::default() };
        assert!(passed.has_passed());
        let mut other = passed.clone();
        other.add(false, 0, 10);
        assert!(!other.has_passed());
        let mut long = passed.clone();
        long.add(true, 0, (TICK_INSTRUCTIONS * TICKS_PER_INSTRUCTION) as u32 + 11);
        assert_eq!((long.deadline_misses, long.has_passed()), (1, false));
        assert!(!SoakResult { host_growth_bytes: GROWTH_BYTES + 1, ..passed }.has_passed());
    }
}
