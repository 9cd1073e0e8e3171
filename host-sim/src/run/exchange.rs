//! Exchange of a run's frames with a controller, in lockstep: one estimate for every frame.

use crate::controller::{Controller, ControllerError, Losses, stopped};
use crate::run::sensing::Sampled;
use link::{Command, ControllerConfiguration, Counters, EstimateFrame, ImpactRecord, SensorFrame};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// Result of an exchange.
#[derive(Clone, Debug, Default)]
pub struct ExchangeResult {
    /// Transport: `native`, `emulated` or `attached`.
    pub controller: &'static str,
    /// One estimate per frame.
    pub estimates: Vec<EstimateFrame>,
    /// Recorded impacts, in the order of their onsets.
    pub impacts: Vec<ImpactRecord>,
    /// The controller's counters at the end.
    pub counters: Counters,
    /// Losses on the line.
    pub losses: Losses,
    /// Wall time of the exchanges in s.
    pub wall_s: f64,
    /// Indices of the frames before which the controller restarted and was configured again.
    pub restarts: Vec<usize>,
}

/// Reaction to a restart of the controller in the middle of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum OnRestart {
    /// End the run with an error.
    #[default]
    Stop,
    /// Configure it again and continue with the unanswered sample. Its history is lost, and its
    /// estimates are flagged accordingly.
    Continue,
}

/// Restarts without an answered sample in between after which a run ends in any case.
const FUTILE_RESTARTS: u32 = 3;

/// Exchanges every frame in lockstep with a configured controller. A restart ends the run.
pub fn exchange<S: Copy + Into<Sampled>>(
    mut controller: Box<dyn Controller>,
    frames: &[S],
) -> Result<ExchangeResult, ControllerError> {
    let mut run = Exchange::new(frames);
    run.run_all(&mut *controller)?;
    run.finish(controller)
}

/// Callback with every sample, its estimate and the impacts that have ended since. Its time does
/// not count as time of the exchange. `Break` ends the run.
pub type Observer<'a> = dyn FnMut(&SensorFrame, &EstimateFrame, &[ImpactRecord]) -> ControlFlow<()> + 'a;

/// As [`exchange`], with a choice about restarts and an observer. `configuration` is the
/// controller's current one.
pub fn exchange_observed<S: Copy + Into<Sampled>>(
    mut controller: Box<dyn Controller>,
    configuration: ControllerConfiguration,
    frames: &[S],
    on_restart: OnRestart,
    see: Option<&mut Observer<'_>>,
) -> Result<ExchangeResult, ControllerError> {
    let mut run = Exchange { see, ..Exchange::new(frames) };
    let mut futile = 0;
    loop {
        let before = run.estimates.len();
        match run.run_all(&mut *controller) {
            Ok(()) => return run.finish(controller),
            Err(ControllerError::Restarted { .. })
                if on_restart == OnRestart::Continue && futile < FUTILE_RESTARTS =>
            {
                futile = if run.estimates.len() > before { 0 } else { futile + 1 };
                run.reconfigure(&mut *controller, configuration)?;
            }
            Err(error) => return Err(error),
        }
    }
}

/// Exchanges the frames with a controller that is configured again before the given frames, as
/// after a restart.
pub fn exchange_with_restarts<S: Copy + Into<Sampled>>(
    mut controller: Box<dyn Controller>,
    configuration: ControllerConfiguration,
    frames: &[S],
    restarts: &[usize],
) -> Result<ExchangeResult, ControllerError> {
    let mut run = Exchange::new(frames);
    for &index in restarts {
        run.run_to(&mut *controller, index)?;
        run.reconfigure(&mut *controller, configuration)?;
        // A restart loses the impact that was open.
        drop(controller.take_impacts());
    }
    run.run_all(&mut *controller)?;
    run.finish(controller)
}

/// State of a run.
struct Exchange<'a, 'b, S> {
    frames: &'a [S],
    see: Option<&'a mut Observer<'b>>,
    seen: Duration,
    estimates: Vec<EstimateFrame>,
    impacts: Vec<ImpactRecord>,
    restarts: Vec<usize>,
    started: Instant,
}

impl<'a, S: Copy + Into<Sampled>> Exchange<'a, '_, S> {
    fn new(frames: &'a [S]) -> Self {
        let estimates = Vec::with_capacity(frames.len());
        let (restarts, started) = (Vec::new(), Instant::now());
        Self { frames, see: None, seen: Duration::ZERO, estimates, impacts: Vec::new(), restarts, started }
    }

    fn run_all(&mut self, controller: &mut dyn Controller) -> Result<(), ControllerError> {
        self.run_to(controller, self.frames.len())
    }

    fn run_to(&mut self, controller: &mut dyn Controller, end: usize) -> Result<(), ControllerError> {
        let due = self.frames.get(self.estimates.len()..end).unwrap_or_default();
        for frame in due {
            let last = self.estimates.last().map(|estimate| estimate.sequence);
            let Sampled { frame, status } = (*frame).into();
            let estimate = controller.sample(&frame, status).map_err(|error| error.after(last))?;
            self.estimates.push(estimate);
            let ended = controller.take_impacts();
            if let Some(see) = &mut self.see {
                let began = Instant::now();
                if see(&frame, &estimate, &ended).is_break() {
                    return Err(ControllerError::Interrupted { last_sequence: frame.sequence });
                }
                self.seen += began.elapsed();
            }
            self.impacts.extend(ended);
        }
        Ok(())
    }

    fn reconfigure(
        &mut self,
        controller: &mut dyn Controller,
        configuration: ControllerConfiguration,
    ) -> Result<(), ControllerError> {
        self.restarts.push(self.estimates.len());
        let last = self.estimates.last().map(|estimate| estimate.sequence);
        // The controller may restart here as well. The next sample would report the same.
        match controller.order(Command::Configure(configuration)) {
            Ok(_) | Err(ControllerError::Restarted { .. }) => Ok(()),
            Err(error) => Err(error.after(last)),
        }
    }

    fn finish(mut self, mut controller: Box<dyn Controller>) -> Result<ExchangeResult, ControllerError> {
        let wall_s = self.started.elapsed().saturating_sub(self.seen).as_secs_f64();
        let last = self.estimates.last().map(|estimate| estimate.sequence);
        let name = controller.name();
        let (_, losses) = controller.link_state();
        let stop = controller.order(Command::Stop).and_then(stopped);
        let counters = stop.map_err(|error| error.after(last))?;
        // An impact that was open ended with the run.
        self.impacts.extend(controller.take_impacts());
        let (estimates, impacts, restarts) = (self.estimates, self.impacts, self.restarts);
        Ok(ExchangeResult { controller: name, estimates, impacts, counters, losses, wall_s, restarts })
    }
}

/// Counts the estimates that differ in any bit of any field except the tick count, and the impacts
/// that differ. A restart may lose an impact, so that a missing one is no difference then.
pub fn bit_differences(a: &ExchangeResult, b: &ExchangeResult) -> u64 {
    let estimates = a.estimates.iter().zip(&b.estimates).filter(|(a, b)| !a.same_bits(b)).count();
    let missing = a.estimates.len().abs_diff(b.estimates.len());
    let impacts = if a.restarts.is_empty() && b.restarts.is_empty() {
        let different = a.impacts.iter().zip(&b.impacts).filter(|(a, b)| a != b).count();
        different + a.impacts.len().abs_diff(b.impacts.len())
    } else {
        let is_fewer = a.impacts.len() <= b.impacts.len();
        let (few, many) = if is_fewer { (&a.impacts, &b.impacts) } else { (&b.impacts, &a.impacts) };
        few.iter().filter(|impact| !many.contains(impact)).count()
    };
    (estimates + impacts + missing) as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::controller::NativeController;
    use controller::configuration::BENCH_B;

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
    fn an_observer_gets_every_sample_and_can_end_the_run() {
        let start = || Box::new(NativeController::start(BENCH_B).unwrap());
        let mut seen = Vec::new();
        let mut see = |sample: &SensorFrame, estimate: &EstimateFrame, _: &[ImpactRecord]| {
            seen.push((sample.sequence, estimate.sequence));
            if sample.sequence == 7 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let complete =
            exchange_observed(start(), BENCH_B, &frames(5), OnRestart::Stop, Some(&mut see)).unwrap();
        assert_eq!(complete.estimates.len(), 5);
        let ended =
            exchange_observed(start(), BENCH_B, &frames(20), OnRestart::Stop, Some(&mut see)).unwrap_err();
        assert!(matches!(ended, ControllerError::Interrupted { last_sequence: 7 }), "{ended}");
        let expected: Vec<(u32, u32)> = (0..5).chain(0..8).map(|sequence| (sequence, sequence)).collect();
        assert_eq!(seen, expected);
    }
}
