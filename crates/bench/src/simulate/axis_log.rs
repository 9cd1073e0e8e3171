//! Logs of a driven axis with a given motion: recording, and simulation under the inputs of a log.
//! [`super::forward_log`] is the other direction.

use super::axis_inputs::{FINENESS, axis_load, measured_motion};
use super::forward_log;
use super::respond::{Inputs, LoggedPlant, Response, Truth, refined};
use crate::description::{FrictionRig, PlantDescription};
use crate::integrate::IntegrationError;
use crate::log::{LogError, MeasuredLog};
use crate::plants::friction_rig::{Given, efforts, efforts_along};
use crate::signals::{Channel, Profile};

impl LoggedPlant for FrictionRig {
    fn inputs(&self, log: &MeasuredLog) -> Result<Inputs, LogError> {
        if let Some(drive) = self.forward() {
            return forward_log::inputs(self, drive, log);
        }
        let drive = measured_motion(self, log).ok_or_else(|| log.missing(self.channels().0))?;
        let load = axis_load(self, log);
        let mut inputs = Inputs::from_profiles(log, self.outputs(log), (drive, load), FINENESS);
        let given = |&t: &f64| Given { time_s: t, motion: inputs.drive(t), load_n: inputs.load_n(t) };
        inputs.course = inputs.fine_s.iter().map(given).collect();
        Ok(inputs)
    }

    fn respond(&self, inputs: &Inputs, is_prompt: bool) -> Result<Truth, IntegrationError> {
        let fineness = if is_prompt { 1 } else { inputs.fineness };
        if let Some(drive) = self.forward() {
            let outputs = forward_log::respond(self, drive, inputs, inputs.fineness / fineness);
            return Ok(Truth { outputs, fineness });
        }
        Ok(Truth { outputs: axis_outputs(self, inputs, inputs.fineness / fineness), fineness })
    }

    fn run(&self) -> Result<(Vec<f64>, Truth), IntegrationError> {
        if let Some(drive) = self.forward() {
            return Ok(forward_log::run(self, drive));
        }
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
