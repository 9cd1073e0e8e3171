//! What a bench would have logged under a measured log's own inputs: the simulation that a diagnosis compares with.

use crate::channel::Channel;
use crate::description::{Bench, FrictionRig};
use crate::follow::{follow, smoothed};
use crate::friction_rig::{Given, efforts_along};
use crate::integrate::IntegrationError;
use crate::log::{LogError, MeasuredLog};
use crate::motion::{Motion, Profile};
use crate::run::{DEFAULT_TOLERANCE, snapshots};
use crate::sensor::Sensor;
use crate::transmission::Snapshot;
use std::collections::BTreeMap;

/// Simulated outputs by channel, one value a sample of the log.
pub type Response = BTreeMap<Channel, Vec<f64>>;

/// Parts of the time between two samples at whose ends the truth is simulated. A sensor that is late reads between the samples, where dry friction may turn
/// round within one of them.
pub(crate) const TRANSMISSION_FINENESS: usize = 8;
pub(crate) const AXIS_FINENESS: usize = 4;

/// The times with so many parts between each and the next.
pub(crate) fn refined(time_s: &[f64], fineness: usize) -> Vec<f64> {
    let parts = time_s.windows(2).flat_map(|pair| {
        let [from, to] = [pair[0], pair[1]];
        (0..fineness)
            .map(move |k| if k == 0 { from } else { from + (to - from) * k as f64 / fineness as f64 })
    });
    parts.chain(time_s.last().copied()).collect()
}

/// What a sensor's electronics make of a truth at refined times, at the samples themselves.
pub(crate) fn reading(sensor: &Sensor, fine_s: &[f64], truth: &[f64], fineness: usize) -> Vec<f64> {
    let sampled = |values: &[f64]| -> Vec<f64> { values.iter().step_by(fineness).copied().collect() };
    if sensor.is_prompt() {
        return sensor.respond(&sampled(fine_s), &sampled(truth));
    }
    sampled(&sensor.respond(fine_s, truth))
}

/// Half window in s of the polynomial that smooths a drive displacement with its velocity.
const DRIVE_HALF_WINDOW_S: f64 = 0.010;
/// Half window in s for a load.
const LOAD_HALF_WINDOW_S: f64 = 0.003;

/// The inputs of a log, smoothed once for many simulations.
#[derive(Clone, Debug)]
pub struct Inputs {
    time_s: Vec<f64>,
    /// Times at which the truth is simulated.
    fine_s: Vec<f64>,
    fineness: usize,
    drive: Profile,
    load: Profile,
    /// Drive and load at the times at which the truth of an axis is simulated: always the same, and half of a simulation.
    course: Vec<Given>,
    outputs: Vec<Channel>,
}

/// Why a simulation of a log failed.
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
    /// Takes the inputs of a log as the plant of `bench` needs them; outputs are simulated where the log has them.
    pub fn new(bench: &Bench, log: &MeasuredLog) -> Result<Self, LogError> {
        let time_s = &log.time_s;
        let outputs = log.outputs().map(|(channel, _)| channel).collect();
        let span = time_s.last().zip(time_s.first()).map_or(0.0, |(b, a)| b - a);
        let step = span / (time_s.len().max(2) - 1) as f64;
        let smooth_load =
            |values: &[f64]| Profile::through(time_s, values, None, LOAD_HALF_WINDOW_S.max(2.0 * step), 2);
        match bench {
            Bench::Transmission(_) => {
                let displacement = log.need(Channel::DriveDisplacement)?;
                let velocity = log.channels.get(&Channel::DriveVelocity).map(Vec::as_slice);
                let load = smooth_load(log.need(Channel::LoadForce)?);
                let half = DRIVE_HALF_WINDOW_S.max(4.0 * step);
                Ok(Self {
                    time_s: time_s.clone(),
                    fine_s: refined(time_s, TRANSMISSION_FINENESS),
                    fineness: TRANSMISSION_FINENESS,
                    drive: Profile::through(time_s, displacement, velocity, half, 4),
                    load,
                    course: Vec::new(),
                    outputs,
                })
            }
            Bench::FrictionRig(rig) => {
                let (position, speed, _) = rig.channels();
                let drive = match (log.channels.get(&position), log.channels.get(&speed)) {
                    (Some(x), v) => follow(time_s, x, v.map(Vec::as_slice)),
                    (None, Some(v)) => integrated(time_s, v),
                    (None, None) => return Err(log.missing(position)),
                };
                let load = match log.channels.get(&Channel::LoadForce) {
                    Some(values) => smooth_load(values),
                    None => Profile::Ramp { level: rig.load.force_n, ramp_s: f64::MIN_POSITIVE },
                };
                let fine_s = refined(time_s, AXIS_FINENESS);
                let given = |&t: &f64| Given { time_s: t, motion: drive.at(t), load_n: load.at(t).value };
                let course = fine_s.iter().map(given).collect();
                Ok(Self {
                    time_s: time_s.clone(),
                    fine_s,
                    fineness: AXIS_FINENESS,
                    drive,
                    load,
                    course,
                    outputs,
                })
            }
        }
    }

    /// The same inputs with the first `count` samples only: a shorter simulation.
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

    /// The drive at a time.
    pub fn drive(&self, time_s: f64) -> Motion {
        self.drive.at(time_s)
    }

    /// The load at a time, N.
    pub fn load_n(&self, time_s: f64) -> f64 {
        self.load.at(time_s).value
    }
}

/// A motion whose rate is measured and whose value is not needed.
fn integrated(time_s: &[f64], rate: &[f64]) -> Profile {
    let smooth = smoothed(time_s, rate);
    let mut value = 0.0;
    let mut nodes: Vec<Motion> = Vec::with_capacity(time_s.len());
    let mut last: Option<(f64, f64)> = None;
    for &t in time_s {
        let here = smooth.at(t);
        if let Some((t0, v0)) = last {
            value += 0.5 * (v0 + here.value) * (t - t0);
        }
        last = Some((t, here.value));
        nodes.push(Motion { value, rate: here.value, acceleration: here.rate });
    }
    Profile::Curve { time_s: time_s.to_vec(), nodes }
}

/// Simulates `bench` (effects applied, sensors' electronics included, noise not) under the inputs of a log.
pub fn respond(bench: &Bench, inputs: &Inputs) -> Result<Response, RespondError> {
    let resolved = bench.resolved();
    let truth = Truth::of(&resolved, inputs)?;
    Ok(sensed(&resolved, inputs, &truth))
}

/// The true outputs of a plant under the inputs of a log, as far between its samples as the sensors need: the costly half of [`respond`].
#[derive(Debug)]
pub struct Truth {
    outputs: Response,
    /// Values a sample.
    fineness: usize,
}

impl Truth {
    /// Simulates a resolved bench.
    pub fn of(resolved: &Bench, inputs: &Inputs) -> Result<Self, RespondError> {
        Ok(match resolved {
            Bench::Transmission(bench) => {
                let end_s = inputs.time_s.last().copied().unwrap_or_default();
                let profiles = (inputs.drive.clone(), inputs.load.clone());
                let samples = snapshots(bench, profiles, end_s, &inputs.fine_s, DEFAULT_TOLERANCE)?;
                Self { outputs: outputs_of(&samples, &inputs.outputs), fineness: inputs.fineness }
            }
            Bench::FrictionRig(rig) => {
                let fineness = if is_prompt(resolved, inputs) { 1 } else { inputs.fineness };
                Self { outputs: axis_outputs(rig, inputs, inputs.fineness / fineness), fineness }
            }
        })
    }

    /// Whether it is fine enough for the sensors of a resolved bench.
    pub fn serves(&self, resolved: &Bench, inputs: &Inputs) -> bool {
        self.fineness == inputs.fineness || is_prompt(resolved, inputs)
    }
}

/// Whether all readings of a bench are of their own time.
fn is_prompt(resolved: &Bench, inputs: &Inputs) -> bool {
    inputs.outputs.iter().all(|channel| resolved.sensors().get(channel).is_none_or(Sensor::is_prompt))
}

/// What the sensors' electronics of a resolved bench make of true outputs that serve it: the cheap half of [`respond`].
pub fn sensed(resolved: &Bench, inputs: &Inputs, truth: &Truth) -> Response {
    debug_assert!(truth.serves(resolved, inputs), "a late sensor reads between the samples");
    let perfect = Sensor::default();
    let times_s = if truth.fineness == 1 { &inputs.time_s } else { &inputs.fine_s };
    let sense = |(channel, values): (&Channel, &Vec<f64>)| {
        let sensor = resolved.sensors().get(channel).unwrap_or(&perfect);
        (*channel, reading(sensor, times_s, values, truth.fineness))
    };
    truth.outputs.iter().map(sense).collect()
}

/// The true outputs of a run on the channels asked for; channels that the bench does not have are left out.
pub fn outputs_of(samples: &[Snapshot], channels: &[Channel]) -> Response {
    let mut response = Response::new();
    for &channel in channels {
        let read: fn(&Snapshot) -> f64 = match channel {
            Channel::ShaftAngle => |s| s.angle_rad,
            Channel::ShaftSpeed => |s| s.speed_rad_s,
            Channel::JournalY => |s| s.y_m,
            Channel::JournalZ => |s| s.z_m,
            Channel::BearingForceY => |s| s.force_y_n,
            Channel::BearingForceZ => |s| s.force_z_n,
            Channel::FrictionTorque => |s| s.friction_torque_nm,
            Channel::DriveForce => |s| s.drive_force_n,
            Channel::DriveDisplacement => |s| s.drive.value,
            Channel::DriveVelocity => |s| s.drive.rate,
            Channel::LoadForce => |s| s.load_force_n,
            _ => continue,
        };
        response.insert(channel, samples.iter().map(read).collect());
    }
    response
}

/// The outputs of an axis at the first of every `every` places of its course.
fn axis_outputs(rig: &FrictionRig, inputs: &Inputs, every: usize) -> Response {
    let (_, _, effort_channel) = rig.channels();
    let efforts = efforts_along(rig, &inputs.course, every, |t| inputs.drive(t));
    let mut response = Response::new();
    for &channel in &inputs.outputs {
        if channel == effort_channel {
            response.insert(channel, efforts.iter().map(|e| e.effort).collect());
        } else if channel == Channel::FrictionTorque {
            response.insert(channel, efforts.iter().map(|e| -e.friction).collect());
        }
    }
    response
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_late_sensor_reads_between_samples_where_friction_turns_round() {
        // Within a fifth of a sample's time, at .4 of it.
        let turn = |t: f64| 100.0 * ((t - 0.0104) / 2e-4).tanh();
        let time_s: Vec<f64> = (0..20).map(|i| f64::from(i) * 1e-3).collect();
        let sensor = Sensor { delay_s: 1.9e-4, ..Sensor::default() };
        let largest = |fineness: usize| {
            let fine_s = refined(&time_s, fineness);
            let truth: Vec<f64> = fine_s.iter().map(|&t| turn(t)).collect();
            let read = reading(&sensor, &fine_s, &truth, fineness);
            assert_eq!(read.len(), time_s.len());
            let off = read.iter().zip(&time_s).map(|(r, t)| (r - turn(t - 1.9e-4)).abs());
            off.skip(1).fold(0.0, f64::max)
        };
        let (coarse, fine) = (largest(1), largest(TRANSMISSION_FINENESS));
        assert!(coarse > 10.0 && fine < 1.0, "{coarse} {fine}");
    }

    #[test]
    fn a_truth_at_the_samples_serves_no_late_sensor_and_no_other_truth_is_finer_there() {
        let mut bench = Bench::open("friction-rig").unwrap();
        bench.set_cycles(1);
        let log = crate::record::record(&bench, 1).unwrap();
        let inputs = Inputs::new(&bench, &log).unwrap();
        let late = |delay_s: f64| {
            let mut bench = bench.clone();
            let Bench::FrictionRig(rig) = &mut bench else { unreachable!("an axis") };
            rig.sensors.entry(Channel::DriveTorque).or_default().delay_s = delay_s;
            bench.resolved()
        };
        let (prompt, late) = (late(0.0), late(1e-3));
        let [at_samples, between] = [&prompt, &late].map(|bench| Truth::of(bench, &inputs).unwrap());
        assert!(at_samples.serves(&prompt, &inputs) && !at_samples.serves(&late, &inputs));
        assert!(between.serves(&prompt, &inputs) && between.serves(&late, &inputs));
        assert_eq!(sensed(&prompt, &inputs, &at_samples), sensed(&prompt, &inputs, &between));
        assert_ne!(sensed(&late, &inputs, &between), sensed(&prompt, &inputs, &between));
    }

    #[test]
    fn refined_times_hold_the_samples() {
        let time_s = [0.1, 0.3, 0.4, 1.1];
        let fine_s = refined(&time_s, 4);
        assert_eq!(fine_s.len(), 13);
        assert_eq!(fine_s.iter().step_by(4).copied().collect::<Vec<_>>(), time_s);
        assert!(fine_s.windows(2).all(|pair| pair[0] < pair[1]) && refined(&[], 4).is_empty());
    }
}
