//! The soak: the emulated controller follows bench B for hours of bench time, estimate by estimate the same as the controller's code in this process.
//!
//! The samples are those of the bench's run through its sensors: several drive cycles, then the last one over and over, with fresh noise each time. Sequence
//! numbers and times start where they are told, near the end of their 32 bits if so, and go round. Samples are written as fast as they are taken
//! and compared in batches; memory of both processes is read after every batch. Every wait is bounded.
//!
//! What is asked: no estimate that differs in any bit, no tick that takes longer than a sample period, no restart, one estimate for every sample,
//! counters and tracked quantities the same at the end, memory of this process that does not grow by more than [`GROWTH_BYTES`] once a tenth has passed. The
//! emulator's own memory is told and not judged: it keeps what it has translated.

use crate::faults::CampaignError;
use crate::faults::attempt::BOUND;
use crate::faults::emulator::{Emulator, Pumped};
use crate::faults::image::Image;
use crate::faults::streams::bytes;
use bench::Bench;
use bench::transmission::{Snapshot, Transmission};
use firmware::flags::ONSET_NOT_SEEN;
use host_sim::controller::{Controller, NativeController};
use host_sim::estimator::controller_configuration;
use host_sim::force::{DEFAULT_STEP_S, ForceSource, SAMPLE_RATE_HZ, run_bench};
use host_sim::paper::resolved;
use host_sim::sensing;
use link::{
    Answer, Command, ControllerConfiguration, NumberedCommand, ReportKind, SensorFrame, ToController, ToHost,
};
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::time::Instant;

/// Growth of this process's memory that is still flat.
pub const GROWTH_BYTES: u64 = 8 << 20;
/// Most instructions of a tick: one a cycle at 168 MHz in 100 us.
pub const PERIOD_INSTRUCTIONS: f64 = 16_800.0;
/// SysTick's ticks of one emulated instruction: 64 ns at 168 MHz.
const TICKS_PER_INSTRUCTION: f64 = 10.752;
/// Drive cycles before the one that is repeated.
const CYCLES: u32 = 3;
/// Samples of a batch: what the pipes hold, about.
const BATCH: usize = 1_000;

/// How long, from where and with which noise.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// Samples.
    pub ticks: u64,
    /// Seed of the noise.
    pub seed: u64,
    /// Sequence number of the first sample.
    pub sequence: u32,
    /// Time of the first sample, us.
    pub time_us: u32,
}

/// What came of it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Soaked {
    /// Samples.
    pub ticks: u64,
    /// Times that the sequence number went round.
    pub sequence_wraps: u32,
    /// Times that the time went round.
    pub time_wraps: u32,
    /// Estimates that differ from those of this process in any bit.
    pub bit_differences: u64,
    /// Ticks longer than a sample period.
    pub deadline_misses: u64,
    /// Fewest instructions of a tick.
    pub instructions_per_tick_min: u64,
    /// Most.
    pub instructions_per_tick_max: u64,
    /// Estimates with any remark but that the onset of the contact was not seen: bench B stands on its bearing from the start.
    pub marked: u64,
    /// Whether counters and tracked quantities were the same at the end.
    pub same_reports: bool,
    /// Most memory of this process after a tenth of the samples, above what it had then, bytes.
    pub host_growth_bytes: u64,
    /// The same of the emulator.
    pub emulator_growth_bytes: u64,
    /// Samples a second, wall time.
    pub ticks_per_s: f64,
}

impl Soaked {
    /// Whether everything is as it has to be.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        self.bit_differences == 0
            && self.deadline_misses == 0
            && self.same_reports
            && self.host_growth_bytes <= GROWTH_BYTES
    }
}

/// The samples, one after the other for ever.
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
        let Bench::Transmission(base) = Bench::open("bench-b").map_err(host_sim::error::CliError::from)?
        else {
            return Err(CampaignError::Unexpected { found: "another plant".into(), expected: "bench-b" });
        };
        let mut bench = resolved(*base)?;
        bench.drive.cycles = CYCLES;
        let forced = run_bench(&bench, ForceSource::Law, DEFAULT_STEP_S, || {})?;
        let plant = Transmission::new(&bench, bench.drive_profile(), bench.load_profile());
        let configuration = controller_configuration(&plant, &bench, SAMPLE_RATE_HZ)?;
        let cycle_samples = (bench.drive.period_s * SAMPLE_RATE_HZ).round() as usize;
        let run = forced.run.samples;
        let cycle = run.get(run.len().saturating_sub(cycle_samples)..).unwrap_or_default().to_vec();
        let bench = Bench::Transmission(Box::new(bench));
        // All of it once: the controller sees the journal land.
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

/// Runs a soak; `done` hears how many samples every batch had.
pub fn soak(elf: &Path, plan: &Plan, mut done: impl FnMut(u64)) -> Result<Soaked, CampaignError> {
    // Anything else would be silent for long before it is told.
    Image::read(elf)?;
    let (configuration, mut samples) = Samples::new(plan)?;
    let mut native = NativeController::start(configuration)?;
    let mut emulator = Emulator::start(elf, false, &["-no-reboot"])?;
    let mut commands = 0;
    order(&mut emulator, &mut commands, Command::Configure(configuration))?;
    let mut soaked = Soaked { ticks: plan.ticks, instructions_per_tick_min: u64::MAX, ..Soaked::default() };
    let (mut left, mut memory, begun) = (plan.ticks, None, Instant::now());
    let mut last = SensorFrame { sequence: plan.sequence, time_us: plan.time_us, ..SensorFrame::default() };
    while left > 0 {
        let batch: Vec<_> = samples.by_ref().take(BATCH.min(left.try_into().unwrap_or(BATCH))).collect();
        emulator.said.clear();
        for frame in &batch {
            emulator.send(&bytes(&ToController::Sensor(*frame, Default::default()))?);
        }
        let is_estimate = |said: &&_| matches!(said, Ok(ToHost::Estimate(_)));
        let pumped = emulator.pump(BOUND, |said| said.iter().filter(is_estimate).count() >= batch.len())?;
        let told = emulator.said.iter().filter(is_estimate).count();
        let estimates = emulator.said.iter().filter_map(|said| match said {
            Ok(ToHost::Estimate(numbered)) => Some(&numbered.estimate),
            _ => None,
        });
        for (frame, estimate) in batch.iter().zip(estimates) {
            soaked.take(
                native.exchange(frame)?.same_bits(estimate),
                estimate.flags,
                estimate.instruction_ticks,
            );
            soaked.sequence_wraps += u32::from(frame.sequence < last.sequence);
            soaked.time_wraps += u32::from(frame.time_us < last.time_us);
            last = *frame;
        }
        let others =
            emulator.said.iter().find(|said| !matches!(said, Ok(ToHost::Estimate(_) | ToHost::Slow(_))));
        if pumped != Pumped::Come || told != batch.len() || others.is_some() {
            return Err(CampaignError::Unexpected {
                found: format!(
                    "{pumped:?} after sample {}, {told} estimates to {} samples, {others:?}",
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
            soaked.host_growth_bytes = soaked.host_growth_bytes.max(now[0].saturating_sub(host));
            soaked.emulator_growth_bytes = soaked.emulator_growth_bytes.max(now[1].saturating_sub(other));
        }
        done(batch.len() as u64);
    }
    soaked.ticks_per_s = plan.ticks as f64 / begun.elapsed().as_secs_f64();
    soaked.same_reports = true;
    for command in
        [Command::GetReport(ReportKind::Track), Command::GetReport(ReportKind::Sensors), Command::GetCounters]
    {
        let emulated = order(&mut emulator, &mut commands, command)?;
        soaked.same_reports &= native.order(command)? == emulated;
    }
    Ok(soaked)
}

impl Soaked {
    fn take(&mut self, same: bool, flags: u32, timer_ticks: u32) {
        let instructions = f64::from(timer_ticks) / TICKS_PER_INSTRUCTION;
        self.bit_differences += u64::from(!same);
        self.marked += u64::from(flags & !ONSET_NOT_SEEN.bits() != 0);
        self.deadline_misses += u64::from(instructions > PERIOD_INSTRUCTIONS);
        self.instructions_per_tick_max = self.instructions_per_tick_max.max(instructions.round() as u64);
        // The first estimate tells of no tick before it.
        if timer_ticks > 0 {
            self.instructions_per_tick_min = self.instructions_per_tick_min.min(instructions.round() as u64);
        }
    }
}

/// Gives the emulated controller a command and takes its answer.
fn order(emulator: &mut Emulator, commands: &mut u32, command: Command) -> Result<Answer, CampaignError> {
    *commands += 1;
    let id = *commands;
    emulator.said.clear();
    emulator.send(&bytes(&ToController::Command(NumberedCommand { id, command }))?);
    let answers =
        |said: &_| matches!(said, Ok(ToHost::Acknowledged(acknowledgement)) if acknowledgement.id == id);
    emulator.pump(2 * BOUND, |said| said.iter().any(answers))?;
    let answer = emulator.said.iter().find_map(|said| match said {
        Ok(ToHost::Acknowledged(acknowledgement)) if acknowledgement.id == id => acknowledgement.outcome.ok(),
        _ => None,
    });
    answer.ok_or_else(|| CampaignError::Unexpected {
        found: format!("{:?}", emulator.said),
        expected: "a command carried out",
    })
}

/// Memory of a process that is in RAM, bytes; 0 where the system does not tell.
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
    fn memory_is_told_where_the_system_tells_it() {
        assert!(resident_bytes(std::process::id()) > 100_000);
        assert_eq!(resident_bytes(u32::MAX), 0);
    }

    #[test]
    fn one_difference_or_a_long_tick_or_growing_memory_is_not_sound() {
        let sound = Soaked { same_reports: true, ..Soaked::default() };
        assert!(sound.is_sound());
        let mut other = sound.clone();
        other.take(false, 0, 10);
        assert!(!other.is_sound());
        let mut long = sound.clone();
        long.take(true, 0, (PERIOD_INSTRUCTIONS * TICKS_PER_INSTRUCTION) as u32 + 11);
        assert_eq!((long.deadline_misses, long.is_sound()), (1, false));
        assert!(!Soaked { host_growth_bytes: GROWTH_BYTES + 1, ..sound }.is_sound());
    }
}
