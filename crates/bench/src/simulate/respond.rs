//! Simulation of a bench under the inputs of a measured log, for comparison with that log.

use crate::description::Bench;
use crate::integrate::IntegrationError;
use crate::log::{LogError, MeasuredLog};
use crate::plants::forward_axis::Start;
use crate::plants::friction_rig::Given;
use crate::signals::{Channel, Motion, Profile, Sensor};
use std::collections::BTreeMap;

/// Simulated outputs by channel, one value per sample of the log.
pub type Response = BTreeMap<Channel, Vec<f64>>;

/// A plant that records logs, and that is simulated under the inputs of one.
pub trait LoggedPlant {
    /// Takes the inputs that the plant needs from a log.
    fn inputs(&self, log: &MeasuredLog) -> Result<Inputs, LogError>;

    /// Simulates the true outputs under the inputs of a log. If `is_prompt` is set, all readings
    /// depend only on the signal at their own time, and values at the samples are sufficient.
    fn respond(&self, inputs: &Inputs, is_prompt: bool) -> Result<Truth, IntegrationError>;

    /// Simulates the described run; returns its refined times and its inputs and outputs at them.
    fn run(&self) -> Result<(Vec<f64>, Truth), IntegrationError>;
}

/// Divides every interval of `time_s` into `fineness` equal parts.
pub(crate) fn refined(time_s: &[f64], fineness: usize) -> Vec<f64> {
    let parts = time_s.windows(2).flat_map(|pair| {
        let [from, to] = [pair[0], pair[1]];
        (0..fineness)
            .map(move |k| if k == 0 { from } else { from + (to - from) * k as f64 / fineness as f64 })
    });
    parts.chain(time_s.last().copied()).collect()
}

/// Readings of a sensor's electronics at the samples, from a truth at refined times.
pub(crate) fn read_samples(sensor: &Sensor, fine_s: &[f64], truth: &[f64], fineness: usize) -> Vec<f64> {
    let sampled = |values: &[f64]| -> Vec<f64> { values.iter().step_by(fineness).copied().collect() };
    if sensor.is_prompt() {
        return sensor.respond(&sampled(fine_s), &sampled(truth));
    }
    sampled(&sensor.respond(fine_s, truth))
}

/// Half window in s of the polynomial that smooths a load.
const LOAD_HALF_WINDOW_S: f64 = 0.003;

/// Input of a simulated motion, and the motion at the start.
#[derive(Clone, Debug)]
pub(crate) struct Command {
    pub(super) profile: Profile,
    /// Noise of a sample of the input.
    pub(super) noise: f64,
    pub(super) start: Start,
    /// Standard deviations of position and speed at the start.
    pub(super) start_noise: [f64; 2],
}

/// Inputs of a log, smoothed once for many simulations.
#[derive(Clone, Debug)]
pub struct Inputs {
    pub(crate) time_s: Vec<f64>,
    /// Times at which the truth is simulated.
    pub(crate) fine_s: Vec<f64>,
    /// Number of simulated intervals per sample of the log. A delayed sensor reads between the
    /// samples, and dry friction may reverse within one of them.
    pub(crate) fineness: usize,
    pub(crate) drive: Profile,
    pub(crate) load: Profile,
    /// Drive and load of an axis at the simulated times. They are the same for all simulations and
    /// take half the time of one.
    pub(crate) course: Vec<Given>,
    /// Input of a simulated motion.
    pub(crate) command: Option<Command>,
    pub(crate) outputs: Vec<Channel>,
}

/// Error of simulating a log.
#[derive(Debug, thiserror::Error)]
pub enum RespondError {
    /// The log lacks an input.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The integrator gave up.
    #[error(transparent)]
    Integration(#[from] IntegrationError),
}

impl Inputs {
    /// Takes the inputs that the plant of `bench` needs from a log. The outputs that the log has
    /// are simulated.
    pub fn new(bench: &Bench, log: &MeasuredLog) -> Result<Self, LogError> {
        let plant = bench.logged().ok_or_else(|| log.plant_without_log(bench.plant_name()))?;
        plant.inputs(log)
    }

    /// Inputs with a motion and a load, simulated at `fineness` times per sample of the log.
    pub(crate) fn from_profiles(
        log: &MeasuredLog,
        outputs: Vec<Channel>,
        (drive, load): (Profile, Profile),
        fineness: usize,
    ) -> Self {
        Self {
            time_s: log.time_s.clone(),
            fine_s: refined(&log.time_s, fineness),
            fineness,
            drive,
            load,
            course: Vec::new(),
            command: None,
            outputs,
        }
    }

    /// Returns the same inputs with the first `count` samples only, for a shorter simulation.
    pub fn first(&self, count: usize) -> Self {
        let mut inputs = self.clone();
        inputs.time_s.truncate(count);
        inputs.fine_s.truncate(count.saturating_sub(1) * self.fineness + count.min(1));
        inputs.course.truncate(inputs.fine_s.len());
        inputs
    }

    /// Times of the log's samples in s.
    pub fn time_s(&self) -> &[f64] {
        &self.time_s
    }

    /// Driven motion at a time.
    pub fn drive(&self, time_s: f64) -> Motion {
        self.drive.at(time_s)
    }

    /// Load at a time, N.
    pub fn load_n(&self, time_s: f64) -> f64 {
        self.load.at(time_s).value
    }
}

/// Load of a log, smoothed.
pub(crate) fn smooth_load(time_s: &[f64], values: &[f64]) -> Profile {
    Profile::through(time_s, values, None, LOAD_HALF_WINDOW_S.max(2.0 * mean_step_s(time_s)), 2)
}

/// Mean time between two samples in s.
pub(crate) fn mean_step_s(time_s: &[f64]) -> f64 {
    let span = time_s.last().zip(time_s.first()).map_or(0.0, |(b, a)| b - a);
    span / (time_s.len().max(2) - 1) as f64
}

/// Simulates `bench` under the inputs of a log, with effects and sensor electronics, without noise.
pub fn respond(bench: &Bench, inputs: &Inputs) -> Result<Response, RespondError> {
    let resolved = bench.resolved();
    let truth = Truth::simulate(&resolved, inputs)?;
    Ok(apply_sensors(&resolved, inputs, &truth))
}

/// True outputs of a plant under the inputs of a log, at the times that its sensors need: the
/// expensive half of [`respond`].
#[derive(Debug)]
pub struct Truth {
    /// Values by channel.
    pub(crate) outputs: Response,
    /// Simulated values per sample.
    pub(crate) fineness: usize,
}

impl Truth {
    /// Simulates a resolved bench.
    pub fn simulate(resolved: &Bench, inputs: &Inputs) -> Result<Self, RespondError> {
        let plant = resolved.logged().ok_or(IntegrationError::NoLog { plant: resolved.plant_name() })?;
        Ok(plant.respond(inputs, is_prompt(resolved, inputs))?)
    }

    /// Returns whether the truth is fine enough for the sensors of a resolved bench.
    pub fn is_fine_enough_for(&self, resolved: &Bench, inputs: &Inputs) -> bool {
        self.fineness == inputs.fineness || is_prompt(resolved, inputs)
    }
}

/// Returns whether all readings of a bench depend only on the signal at their own time.
fn is_prompt(resolved: &Bench, inputs: &Inputs) -> bool {
    inputs.outputs.iter().all(|channel| resolved.sensors().get(channel).is_none_or(Sensor::is_prompt))
}

/// Returns what the sensors of a resolved bench read of true outputs that are fine enough: the
/// cheap half of [`respond`].
pub fn apply_sensors(resolved: &Bench, inputs: &Inputs, truth: &Truth) -> Response {
    debug_assert!(truth.is_fine_enough_for(resolved, inputs), "a late sensor reads between the samples");
    let perfect = Sensor::default();
    let times_s = if truth.fineness == 1 { &inputs.time_s } else { &inputs.fine_s };
    let sense = |(channel, values): (&Channel, &Vec<f64>)| {
        let sensor = resolved.sensors().get(channel).unwrap_or(&perfect);
        (*channel, read_samples(sensor, times_s, values, truth.fineness))
    };
    truth.outputs.iter().map(sense).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_delayed_sensor_resolves_a_reversal_between_samples() {
        // A reversal within a fifth of a sample's time, at 0.4 of it.
        let turn = |t: f64| 100.0 * ((t - 0.0104) / 2e-4).tanh();
        let time_s: Vec<f64> = (0..20).map(|i| f64::from(i) * 1e-3).collect();
        let sensor = Sensor { delay_s: 1.9e-4, ..Sensor::default() };
        let largest = |fineness: usize| {
            let fine_s = refined(&time_s, fineness);
            let truth: Vec<f64> = fine_s.iter().map(|&t| turn(t)).collect();
            let read = read_samples(&sensor, &fine_s, &truth, fineness);
            assert_eq!(read.len(), time_s.len());
            let off = read.iter().zip(&time_s).map(|(r, t)| (r - turn(t - 1.9e-4)).abs());
            off.skip(1).fold(0.0, f64::max)
        };
        let (coarse, fine) = (largest(1), largest(8));
        assert!(coarse > 10.0 && fine < 1.0, "{coarse} {fine}");
    }

    #[test]
    fn a_delayed_sensor_needs_a_truth_between_the_samples() {
        let mut bench = Bench::open("friction-rig").unwrap();
        bench.set_cycles(1);
        let log = crate::simulate::record(&bench, 1).unwrap();
        let inputs = Inputs::new(&bench, &log).unwrap();
        let late = |delay_s: f64| {
            let mut bench = bench.clone();
            bench.sensors_mut().entry(Channel::DriveTorque).or_default().delay_s = delay_s;
            bench.resolved()
        };
        let (prompt, late) = (late(0.0), late(1e-3));
        let [at_samples, between] = [&prompt, &late].map(|bench| Truth::simulate(bench, &inputs).unwrap());
        assert!(
            at_samples.is_fine_enough_for(&prompt, &inputs) && !at_samples.is_fine_enough_for(&late, &inputs)
        );
        assert!(between.is_fine_enough_for(&prompt, &inputs) && between.is_fine_enough_for(&late, &inputs));
        assert_eq!(apply_sensors(&prompt, &inputs, &at_samples), apply_sensors(&prompt, &inputs, &between));
        assert_ne!(apply_sensors(&late, &inputs, &between), apply_sensors(&prompt, &inputs, &between));
    }

    #[test]
    fn refined_times_contain_the_samples() {
        let time_s = [0.1, 0.3, 0.4, 1.1];
        let fine_s = refined(&time_s, 4);
        assert_eq!(fine_s.len(), 13);
        assert_eq!(fine_s.iter().step_by(4).copied().collect::<Vec<_>>(), time_s);
        assert!(fine_s.windows(2).all(|pair| pair[0] < pair[1]) && refined(&[], 4).is_empty());
    }
}
