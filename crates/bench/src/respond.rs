//! What a bench would have logged under a measured log's own inputs: the simulation that a diagnosis compares with.

use crate::channel::Channel;
use crate::description::{Bench, FrictionRig};
use crate::follow::follow;
use crate::friction_rig;
use crate::integrate::IntegrationError;
use crate::log::{LogError, MeasuredLog};
use crate::motion::{Motion, Profile};
use crate::run::{DEFAULT_TOLERANCE, snapshots};
use crate::sensor::Sensor;
use crate::transmission::Snapshot;
use std::collections::BTreeMap;

/// Simulated outputs by channel, one value a sample of the log.
pub type Response = BTreeMap<Channel, Vec<f64>>;

/// Half window in s of the polynomial that smooths a drive displacement with its velocity.
const DRIVE_HALF_WINDOW_S: f64 = 0.010;
/// Half window in s for a load.
const LOAD_HALF_WINDOW_S: f64 = 0.003;

/// The inputs of a log, smoothed once for many simulations.
#[derive(Clone, Debug)]
pub struct Inputs {
    time_s: Vec<f64>,
    drive: Profile,
    load: Profile,
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
                    drive: Profile::through(time_s, displacement, velocity, half, 4),
                    load,
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
                Ok(Self { time_s: time_s.clone(), drive, load, outputs })
            }
        }
    }

    /// The same inputs with the first `count` samples only: a shorter simulation.
    pub fn first(&self, count: usize) -> Self {
        let mut inputs = self.clone();
        inputs.time_s.truncate(count);
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
    let smooth = follow(time_s, rate, None);
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
    let truth = truth(&resolved, inputs)?;
    Ok(sensed(&resolved, inputs, &truth))
}

/// The true outputs of a resolved bench under the inputs of a log: the costly half of [`respond`].
pub fn truth(resolved: &Bench, inputs: &Inputs) -> Result<Response, RespondError> {
    Ok(match resolved {
        Bench::Transmission(bench) => {
            let end_s = inputs.time_s.last().copied().unwrap_or_default();
            let profiles = (inputs.drive.clone(), inputs.load.clone());
            let samples = snapshots(bench, profiles, end_s, &inputs.time_s, DEFAULT_TOLERANCE)?;
            outputs_of(&samples, &inputs.outputs)
        }
        Bench::FrictionRig(rig) => axis_outputs(rig, inputs),
    })
}

/// What the sensors' electronics of a resolved bench make of true outputs: the cheap half of [`respond`].
pub fn sensed(resolved: &Bench, inputs: &Inputs, truth: &Response) -> Response {
    let perfect = Sensor::default();
    let sense = |(channel, values): (&Channel, &Vec<f64>)| {
        let sensor = resolved.sensors().get(channel).unwrap_or(&perfect);
        (*channel, sensor.respond(&inputs.time_s, values))
    };
    truth.iter().map(sense).collect()
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

fn axis_outputs(rig: &FrictionRig, inputs: &Inputs) -> Response {
    let (_, _, effort_channel) = rig.channels();
    let efforts = friction_rig::efforts(rig, &inputs.time_s, |t| inputs.drive(t), |t| inputs.load_n(t));
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
