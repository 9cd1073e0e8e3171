//! Logs of a driven axis: recording, and simulation under the inputs of a log.

use super::respond::{Inputs, LoggedPlant, Response, Truth, refined, smooth_load};
use crate::description::FrictionRig;
use crate::integrate::IntegrationError;
use crate::log::{LogError, MeasuredLog};
use crate::plants::friction_rig::{Given, efforts, efforts_along};
use crate::signals::{Channel, Motion, Profile, follow, smoothed};

/// Number of simulated intervals per sample.
const FINENESS: usize = 4;

impl LoggedPlant for FrictionRig {
    fn inputs(&self, log: &MeasuredLog) -> Result<Inputs, LogError> {
        let time_s = &log.time_s;
        let (position, speed, _) = self.channels();
        let drive = match (log.channels.get(&position), log.channels.get(&speed)) {
            (Some(x), v) => follow(time_s, x, v.map(Vec::as_slice)),
            (None, Some(v)) => integrated(time_s, v),
            (None, None) => return Err(log.missing(position)),
        };
        let load = match log.channels.get(&Channel::LoadForce) {
            Some(values) => smooth_load(time_s, values),
            None => Profile::Ramp { level: self.load.force_n, ramp_s: f64::MIN_POSITIVE },
        };
        let mut inputs = Inputs::from_profiles(log, (drive, load), FINENESS);
        let given = |&t: &f64| Given { time_s: t, motion: inputs.drive(t), load_n: inputs.load_n(t) };
        inputs.course = inputs.fine_s.iter().map(given).collect();
        Ok(inputs)
    }

    fn respond(&self, inputs: &Inputs, is_prompt: bool) -> Result<Truth, IntegrationError> {
        let fineness = if is_prompt { 1 } else { inputs.fineness };
        Ok(Truth { outputs: axis_outputs(self, inputs, inputs.fineness / fineness), fineness })
    }

    fn run(&self) -> Result<(Vec<f64>, Truth), IntegrationError> {
        let drive = self.axis.motion();
        let load = Profile::Ramp { level: self.load.force_n, ramp_s: self.load.ramp_s };
        let count = (self.axis.duration_s() * self.logging.sample_rate_hz).round() as usize;
        let samples_s: Vec<f64> = (0..count).map(|i| i as f64 / self.logging.sample_rate_hz).collect();
        let fine_s = refined(&samples_s, FINENESS);
        let (position, speed, effort) = self.channels();
        let at = |read: &dyn Fn(f64) -> f64| fine_s.iter().map(|&t| read(t)).collect::<Vec<f64>>();
        let efforts = efforts(self, &fine_s, |t| drive.at(t), |t| load.at(t).value);
        let mut outputs = Response::from([
            (position, at(&|t| drive.at(t).value)),
            (speed, at(&|t| drive.at(t).rate)),
            (Channel::LoadForce, at(&|t| load.at(t).value)),
            (effort, efforts.iter().map(|e| e.effort).collect()),
        ]);
        if self.surface.is_some() {
            outputs.insert(Channel::FrictionTorque, efforts.iter().map(|e| -e.friction).collect());
        }
        Ok((fine_s, Truth { outputs, fineness: FINENESS }))
    }
}

/// Outputs of an axis at every `every`-th place of its course.
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

/// Motion whose rate is measured and whose value is not needed.
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
