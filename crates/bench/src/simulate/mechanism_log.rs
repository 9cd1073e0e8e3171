//! Logs of a mechanism: recording of the channels of `[[measured]]`, and simulation at the times of
//! a log. The drives follow the description, so a log needs no input.

use super::respond::{Inputs, LoggedPlant, Response, Truth, refined};
use crate::description::{JointKind, JointSection, MechanismBench, PlantDescription, Quantity};
use crate::integrate::IntegrationError;
use crate::log::{LogError, MeasuredLog};
use crate::plants::mechanism::Snapshot;
use crate::signals::{Channel, Motion, Profile};
use core::f64::consts::TAU;

/// Number of simulated intervals per sample.
const FINENESS: usize = 8;

impl MechanismBench {
    /// Times of the log's samples in s.
    fn log_times_s(&self) -> Vec<f64> {
        let count = self.run.samples;
        (0..count).map(|i| self.run.duration_s * f64::from(i) / f64::from(count)).collect()
    }

    /// Motion of a drive at the times of a log: the one whose torque is measured, else the first.
    /// The angle of one that turns is within a turn.
    fn drive_profile(&self, time_s: &[f64]) -> Profile {
        let measured = self.quantities().find_map(|quantity| match quantity {
            (Channel::DriveTorque, Quantity::Effort(drive)) => self.drives().nth(drive),
            _ => None,
        });
        let drive = measured.or_else(|| self.joint.iter().find(|joint| joint.is_driven()));
        let node = |time_s: &f64| {
            let motion = drive.map(|joint| joint.motion().at(*time_s)).unwrap_or_default();
            let turns = drive.is_some_and(|j| j.kind == JointKind::Revolute && j.drive_speed.is_some());
            Motion { value: if turns { motion.value.rem_euclid(TAU) } else { motion.value }, ..motion }
        };
        Profile::Curve { time_s: time_s.to_vec(), nodes: time_s.iter().map(node).collect() }
    }

    /// True signals of all measured channels.
    fn truth(&self, samples: &[Snapshot]) -> Response {
        let drives: Vec<&JointSection> = self.drives().collect();
        let clearances = self.joint.iter().flat_map(|joint| std::iter::repeat_n(joint, joint.contacts()));
        let clearances: Vec<&JointSection> = clearances.collect();
        let of_channel =
            |quantity: Quantity| samples.iter().map(|s| read(s, quantity, &drives, &clearances)).collect();
        self.quantities().map(|(channel, quantity)| (channel, of_channel(quantity))).collect()
    }
}

/// Value of a quantity, NaN of one that the mechanism does not have.
fn read(s: &Snapshot, quantity: Quantity, drives: &[&JointSection], joints: &[&JointSection]) -> f64 {
    let value = match quantity {
        Quantity::Body(body, 0) => s.bodies.get(body).map(|b| b.position[2]),
        Quantity::Body(body, _) => s.bodies.get(body).map(|b| b.rate[2]),
        Quantity::Drive(drive, order) => drives.get(drive).map(|joint| {
            let motion = joint.motion().at(s.time_s);
            if order == 0 { motion.value } else { motion.rate }
        }),
        Quantity::Effort(drive) => s.drives.get(drive).copied(),
        Quantity::Journal(contact, axis) => s.contacts.get(contact).map(|c| c.offset_m[axis]),
        Quantity::Force(contact, axis) => s.contacts.get(contact).map(|c| {
            let [x, y] = c.offset_m;
            let distance_m = x.hypot(y).max(f64::MIN_POSITIVE);
            let (n, t) = ([x / distance_m, y / distance_m], [-y / distance_m, x / distance_m]);
            c.friction_n * t[axis] - c.normal_n * n[axis]
        }),
        Quantity::Torque(contact) => s.contacts.get(contact).zip(joints.get(contact)).map(|(c, joint)| {
            let radius_m = joint.bearing_radius_m.unwrap_or_default() - joint.clearance_m.unwrap_or_default();
            debug_assert!(joint.kind == JointKind::Clearance, "only such a joint has a journal");
            c.friction_n * radius_m
        }),
    };
    value.unwrap_or(f64::NAN)
}

impl LoggedPlant for MechanismBench {
    fn inputs(&self, log: &MeasuredLog) -> Result<Inputs, LogError> {
        if let Some(first_s) = log.time_s.first().filter(|first_s| **first_s < 0.0) {
            let (file, found) = (log.source.clone(), format!("t_s from {first_s}"));
            let expected = "t_s from 0, the start of a mechanism, on".into();
            return Err(LogError::Content { file, found, expected });
        }
        let still = Profile::Cycles { stroke: 0.0, period_s: 1.0, cycles: 0.0 };
        let outputs = self.outputs(log).into_iter().filter(|channel| self.simulates(*channel)).collect();
        Ok(Inputs::from_profiles(log, outputs, (self.drive_profile(&log.time_s), still), FINENESS))
    }

    fn respond(&self, inputs: &Inputs, _: bool) -> Result<Truth, IntegrationError> {
        let mut bench = self.clone();
        bench.run.duration_s = inputs.time_s.last().copied().unwrap_or_default();
        let mut outputs = self.truth(&bench.simulate(&inputs.fine_s, self.run.tolerance)?.samples);
        outputs.retain(|channel, _| inputs.outputs.contains(channel));
        Ok(Truth { outputs, fineness: inputs.fineness })
    }

    fn run(&self) -> Result<(Vec<f64>, Truth), IntegrationError> {
        let fine_s = refined(&self.log_times_s(), FINENESS);
        let samples = self.simulate(&fine_s, self.run.tolerance)?.samples;
        Ok((fine_s, Truth { outputs: self.truth(&samples), fineness: FINENESS }))
    }
}
