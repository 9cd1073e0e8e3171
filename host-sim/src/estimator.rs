//! The estimator following a run: frames out, estimates back, and what they are worth.

use crate::controller::{Controller, ControllerError, Losses};
use crate::error::CliError;
use crate::force::bearing_of;
use crate::same_signals::OnSignals;
use crate::sensing::Sampled;
use crate::summary::{Differences, EstimatorSummary, after_start, peak};
use bench::description::TransmissionBench;
use bench::transmission::{Snapshot, Transmission};
use contact::{Dissipation, Material, effective_modulus_pa};
use firmware::flags::SENSOR_FAULT;
use inference::Flags;
use link::track::MonitorConfiguration;
use link::{Command, Configuration, ControllerConfiguration, Counters, EstimateFrame, SensorFrame};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// Timer ticks of an instruction on the emulated controller: 64 ns an instruction at 168 MHz.
const TICKS_PER_INSTRUCTION: f64 = 10.752;

/// What a controller made of a run's frames.
#[derive(Clone, Debug)]
pub struct Tracked {
    /// Where it ran.
    pub controller: &'static str,
    /// One estimate a frame.
    pub estimates: Vec<EstimateFrame>,
    /// The controller's counters at the end.
    pub counters: Counters,
    /// What the line lost.
    pub losses: Losses,
    /// Wall time of the exchanges in s.
    pub wall_s: f64,
    /// Frames before which the controller restarted and was configured anew, by index.
    pub restarts: Vec<usize>,
}

/// What to do about a controller that has restarted in the middle of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum OnRestart {
    /// End the run with an error.
    #[default]
    Stop,
    /// Configure it anew and go on with the sample that it had not answered. Its history is gone, and its estimates say so.
    Continue,
}

/// Restarts without an answered sample between them after which a run ends in any case.
const FUTILE_RESTARTS: u32 = 3;

/// The configuration of the controller for a bench: nominal values, as a user would set them.
pub fn configuration(
    plant: &Transmission,
    bench: &TransmissionBench,
    rate_hz: f64,
) -> Result<Configuration, CliError> {
    let counts = |field: &str, value: f64, unit: f64| {
        let count = (value / unit).round();
        if (1.0..=f64::from(u32::MAX)).contains(&count) {
            Ok(count as u32)
        } else {
            Err(CliError::Input(format!(
                "{field}: found {value}; expected 1 to {} units of {unit}",
                u32::MAX
            )))
        }
    };
    Ok(Configuration {
        bearing: bearing_of(bench.bearing.material).code(),
        radial_clearance_nm: counts("bearing.radial_clearance_m", plant.radial_clearance_m(), 1e-9)?,
        journal_radius_nm: counts("journal radius", plant.journal_radius_m(), 1e-9)?,
        sample_period_us: counts("sample period", 1.0 / rate_hz, 1e-6)?,
        latch_floor_um_s: counts("contact.latch_floor_m_s", bench.contact.latch_floor_m_s, 1e-6)?,
        // The windows are not yet full when the journal lands, so the controller has to be told how this bench starts.
        unseen_approach_um_s: counts("landing speed", plant.landing_speed_m_s(), 1e-6)?,
    })
}

/// All that the controller of a bench is told; limits and calibration as they are by default.
pub fn controller_configuration(
    plant: &Transmission,
    bench: &TransmissionBench,
    rate_hz: f64,
) -> Result<ControllerConfiguration, CliError> {
    let whole = configuration(plant, bench, rate_hz)?;
    let default = firmware::configuration::BENCH_B.monitor;
    let counts = |value: f64, unit: f64| (value / unit).round() as u32;
    let modulus_pa = |youngs_pa, poisson| {
        Material::new(youngs_pa, poisson).map(|bearing| effective_modulus_pa(&bearing, &Material::STEEL))
    };
    let modulus_pa = modulus_pa(bench.bearing.youngs_modulus_pa, bench.bearing.poisson_ratio)
        .map_err(|e| CliError::Input(format!("bearing: {e}")))?;
    let monitor = MonitorConfiguration {
        mass_g: counts(bench.shaft.mass_kg, 1e-3),
        inertia_g_m2: counts(bench.shaft.inertia_kg_m2, 1e-3),
        drive_lever_um: counts(bench.geometry.drive_lever_radius_m, 1e-6),
        load_lever_um: counts(bench.geometry.load_lever_radius_m, 1e-6),
        effective_modulus_kpa: counts(modulus_pa, 1e3),
        damping_per_mille: counts(Dissipation::ZhiyingQishao.factor(bench.bearing.restitution), 1e-3),
        ..default
    };
    Ok(ControllerConfiguration::new(whole, monitor))
}

/// Exchanges every frame in lockstep with a configured controller; a restart ends the run.
pub fn track<S: Copy + Into<Sampled>>(
    mut controller: Box<dyn Controller>,
    frames: &[S],
) -> Result<Tracked, ControllerError> {
    let mut run = Exchange::new(frames);
    run.go_on(&mut *controller)?;
    run.finish(controller)
}

/// Sees every sample with its estimate as they come; its time does not count as the exchange's. Break ends the run.
pub type See<'a> = dyn FnMut(&SensorFrame, &EstimateFrame) -> ControlFlow<()> + 'a;

/// As [`track`], with a choice about restarts; `configuration` is what the controller was given.
pub fn track_through<S: Copy + Into<Sampled>>(
    controller: Box<dyn Controller>,
    configuration: ControllerConfiguration,
    frames: &[S],
    on_restart: OnRestart,
) -> Result<Tracked, ControllerError> {
    track_seen(controller, configuration, frames, on_restart, None)
}

/// As [`track_through`], with somebody who watches.
pub fn track_seen<S: Copy + Into<Sampled>>(
    mut controller: Box<dyn Controller>,
    configuration: ControllerConfiguration,
    frames: &[S],
    on_restart: OnRestart,
    see: Option<&mut See<'_>>,
) -> Result<Tracked, ControllerError> {
    let mut run = Exchange { see, ..Exchange::new(frames) };
    let mut futile = 0;
    loop {
        let before = run.estimates.len();
        match run.go_on(&mut *controller) {
            Ok(()) => return run.finish(controller),
            Err(ControllerError::Restarted { .. })
                if on_restart == OnRestart::Continue && futile < FUTILE_RESTARTS =>
            {
                futile = if run.estimates.len() > before { 0 } else { futile + 1 };
                run.configure_anew(&mut *controller, configuration)?;
            }
            Err(error) => return Err(error),
        }
    }
}

/// What a controller would have said that restarted where another one did.
pub fn track_restarting<S: Copy + Into<Sampled>>(
    mut controller: Box<dyn Controller>,
    configuration: ControllerConfiguration,
    frames: &[S],
    restarts: &[usize],
) -> Result<Tracked, ControllerError> {
    let mut run = Exchange::new(frames);
    for &index in restarts {
        run.go_on_to(&mut *controller, index)?;
        run.configure_anew(&mut *controller, configuration)?;
    }
    run.go_on(&mut *controller)?;
    run.finish(controller)
}

/// A run under way.
struct Exchange<'a, 'b, S> {
    frames: &'a [S],
    see: Option<&'a mut See<'b>>,
    seen: Duration,
    estimates: Vec<EstimateFrame>,
    restarts: Vec<usize>,
    started: Instant,
}

impl<'a, S: Copy + Into<Sampled>> Exchange<'a, '_, S> {
    fn new(frames: &'a [S]) -> Self {
        let estimates = Vec::with_capacity(frames.len());
        let (restarts, started) = (Vec::new(), Instant::now());
        Self { frames, see: None, seen: Duration::ZERO, estimates, restarts, started }
    }

    fn go_on(&mut self, controller: &mut dyn Controller) -> Result<(), ControllerError> {
        self.go_on_to(controller, self.frames.len())
    }

    fn go_on_to(&mut self, controller: &mut dyn Controller, end: usize) -> Result<(), ControllerError> {
        let due = self.frames.get(self.estimates.len()..end).unwrap_or_default();
        for frame in due {
            let last = self.estimates.last().map(|estimate| estimate.sequence);
            let Sampled { frame, status } = (*frame).into();
            let estimate = controller.sample(&frame, status).map_err(|error| error.after(last))?;
            self.estimates.push(estimate);
            if let Some(see) = &mut self.see {
                let began = Instant::now();
                if see(&frame, &estimate).is_break() {
                    return Err(ControllerError::Interrupted { last_sequence: frame.sequence });
                }
                self.seen += began.elapsed();
            }
        }
        Ok(())
    }

    fn configure_anew(
        &mut self,
        controller: &mut dyn Controller,
        configuration: ControllerConfiguration,
    ) -> Result<(), ControllerError> {
        self.restarts.push(self.estimates.len());
        let last = self.estimates.last().map(|estimate| estimate.sequence);
        // It may restart here as well; the next look at a sample would tell nothing else.
        match controller.order(Command::Configure(configuration)) {
            Ok(_) | Err(ControllerError::Restarted { .. }) => Ok(()),
            Err(error) => Err(error.after(last)),
        }
    }

    fn finish(self, controller: Box<dyn Controller>) -> Result<Tracked, ControllerError> {
        let wall_s = self.started.elapsed().saturating_sub(self.seen).as_secs_f64();
        let last = self.estimates.last().map(|estimate| estimate.sequence);
        let name = controller.name();
        let (_, losses) = controller.heard();
        let counters = controller.finish().map_err(|error| error.after(last))?;
        let (estimates, restarts) = (self.estimates, self.restarts);
        Ok(Tracked { controller: name, estimates, counters, losses, wall_s, restarts })
    }
}

/// Estimates that differ in any bit of any field but the tick count.
pub fn bit_differences(a: &Tracked, b: &Tracked) -> u64 {
    let pairs = a.estimates.iter().zip(&b.estimates).filter(|(a, b)| !a.same_bits(b)).count();
    (pairs + a.estimates.len().abs_diff(b.estimates.len())) as u64
}

impl EstimatorSummary {
    /// Holds the estimates against the true forces at the same samples, and against what else could be made of the signals.
    pub fn of(
        bench: &TransmissionBench,
        truth: &[Snapshot],
        tracked: &Tracked,
        same_signals: &[OnSignals],
        differences: Option<u64>,
    ) -> Self {
        let counted = after_start(bench, truth);
        let skipped = truth.len() - counted.len();
        let estimates = tracked.estimates.iter().skip(skipped);
        let estimates = estimates.map(|e| [f64::from(e.normal_force_n), f64::from(e.friction_torque_nm)]);
        let on_signals = same_signals.iter().skip(skipped);
        let against_truth = Differences::of(
            estimates.clone().zip(counted).map(|(e, s)| [e, [s.forces.normal_n, s.friction_torque_nm]]),
        );
        let share = |flags: Flags| {
            let hits =
                tracked.estimates.iter().filter(|e| Flags::from_bits(e.flags).intersects(flags)).count();
            hits as f64 / tracked.estimates.len().max(1) as f64
        };
        let instructions = |ticks: Option<u32>| {
            ticks.filter(|&t| t > 0).map(|t| (f64::from(t) / TICKS_PER_INSTRUCTION).round() as u64)
        };
        let ticks = || tracked.estimates.iter().map(|e| e.instruction_ticks);
        Self {
            controller: tracked.controller,
            force_rms_error_n: against_truth.force_rms_n,
            force_full_scale_n: peak(counted, |s| s.forces.normal_n),
            ticks: tracked.estimates.len() as u64,
            deadline_misses: u64::from(tracked.counters.deadline_overruns),
            // The first estimate tells of no tick before it.
            instructions_per_tick_min: instructions(ticks().filter(|&ticks| ticks > 0).min()),
            instructions_per_tick_mean: mean_instructions(&tracked.estimates),
            instructions_per_tick_max: instructions(ticks().max()),
            exchanges_per_s: tracked.estimates.len() as f64 / tracked.wall_s.max(1e-9),
            native_emulated_bit_differences: differences.filter(|_| tracked.controller == "emulated"),
            native_attached_bit_differences: differences.filter(|_| tracked.controller == "attached"),
            restarts: tracked.restarts.len() as u64,
            outside_training_share: share(Flags::OUTSIDE_TRAINING),
            suspect_share: share(SENSOR_FAULT),
            against_truth,
            against_float: Differences::of(
                estimates.clone().zip(on_signals.clone()).map(|(e, on)| [e, on.float_network]),
            ),
            against_law: Differences::of(estimates.zip(on_signals).map(|(e, on)| [e, on.law])),
            counters: tracked.counters,
            losses: tracked.losses,
        }
    }
}

/// Mean instructions of the ticks that estimates tell of; none where nothing counts them.
fn mean_instructions(estimates: &[EstimateFrame]) -> Option<f64> {
    let counted = || estimates.iter().map(|e| f64::from(e.instruction_ticks)).filter(|&ticks| ticks > 0.0);
    let count = counted().count();
    (count > 0).then(|| counted().sum::<f64>() / count as f64 / TICKS_PER_INSTRUCTION)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::controller::NativeController;
    use firmware::configuration::BENCH_B;

    fn frames(count: u32) -> Vec<SensorFrame> {
        let frame = |sequence: u32| SensorFrame {
            sequence,
            time_us: sequence * BENCH_B.bench.sample_period_us,
            journal_z_nm: -510_000,
            ..SensorFrame::default()
        };
        (0..count).map(frame).collect()
    }

    #[test]
    fn whoever_watches_sees_every_sample_and_may_end_the_run() {
        let start = || Box::new(NativeController::start(BENCH_B).unwrap());
        let mut seen = Vec::new();
        let mut see = |sample: &SensorFrame, estimate: &EstimateFrame| {
            seen.push((sample.sequence, estimate.sequence));
            if sample.sequence == 7 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let whole = track_seen(start(), BENCH_B, &frames(5), OnRestart::Stop, Some(&mut see)).unwrap();
        assert_eq!(whole.estimates.len(), 5);
        let ended = track_seen(start(), BENCH_B, &frames(20), OnRestart::Stop, Some(&mut see)).unwrap_err();
        assert!(matches!(ended, ControllerError::Interrupted { last_sequence: 7 }), "{ended}");
        let expected: Vec<(u32, u32)> = (0..5).chain(0..8).map(|sequence| (sequence, sequence)).collect();
        assert_eq!(seen, expected);
    }
}
