//! Quantities that the channels of a mechanism's log measure.

use super::{MeasuredEntry, MechanismBench};
use crate::description::Refusal;
use crate::signals::Channel;

/// Quantity that a channel measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quantity {
    /// Angle (0) or angular speed (1) of a body.
    Body(usize, usize),
    /// Prescribed value (0) or rate (1) of a drive.
    Drive(usize, usize),
    /// Force or torque of a drive.
    Effort(usize),
    /// Position of a journal in its bearing along an axis.
    Journal(usize, usize),
    /// Force of a bearing on its journal along an axis.
    Force(usize, usize),
    /// Torque of a bearing on its journal.
    Torque(usize),
}

impl MechanismBench {
    /// Quantity of an entry, or the names of which its channel needs one.
    fn quantity(&self, entry: &MeasuredEntry) -> Result<Quantity, Vec<String>> {
        let find = |names: Vec<String>| names.iter().position(|name| *name == entry.of).ok_or(names);
        let body = || find(self.body.iter().map(|body| body.name.clone()).collect());
        let drive = |unit: &str| -> Result<usize, Vec<String>> {
            let drives = self.drive_names();
            let is_own = |i: &usize| drives.get(*i).is_some_and(|drive| drive.1 == unit);
            let names = || drives.iter().map(|drive| drive.0.clone()).collect::<Vec<_>>();
            let own = drives.iter().filter(|drive| drive.1 == unit).map(|drive| drive.0.clone());
            find(names()).ok().filter(is_own).ok_or_else(|| own.collect())
        };
        let joint = || -> Result<usize, Vec<String>> {
            let joints = self.contact_names().into_iter().zip(self.are_clearance());
            let own = || joints.clone().filter(|joint| joint.1).map(|joint| joint.0);
            find(self.contact_names())
                .ok()
                .filter(|_| own().any(|name| name == entry.of))
                .ok_or_else(|| own().collect())
        };
        Ok(match entry.channel {
            Channel::ShaftAngle => Quantity::Body(body()?, 0),
            Channel::ShaftSpeed => Quantity::Body(body()?, 1),
            Channel::SpindleAngle => Quantity::Drive(drive("nm")?, 0),
            Channel::SpindleSpeed => Quantity::Drive(drive("nm")?, 1),
            Channel::Position => Quantity::Drive(drive("n")?, 0),
            Channel::Velocity => Quantity::Drive(drive("n")?, 1),
            Channel::DriveTorque => Quantity::Effort(drive("nm")?),
            Channel::DriveForce => Quantity::Effort(drive("n")?),
            Channel::JournalY => Quantity::Journal(joint()?, 0),
            Channel::JournalZ => Quantity::Journal(joint()?, 1),
            Channel::BearingForceY => Quantity::Force(joint()?, 0),
            Channel::BearingForceZ => Quantity::Force(joint()?, 1),
            Channel::FrictionTorque => Quantity::Torque(joint()?),
            _ => return Err(Vec::new()),
        })
    }

    /// Channels of a log with their quantities.
    pub(crate) fn quantities(&self) -> impl Iterator<Item = (Channel, Quantity)> {
        self.measured.iter().filter_map(|entry| Some((entry.channel, self.quantity(entry).ok()?)))
    }

    /// Refuses channels that measure nothing, that are measured twice, and sensors without a
    /// channel.
    pub(super) fn refuse_measured(&self, all: &mut Vec<Refusal>) {
        for (i, entry) in self.measured.iter().enumerate() {
            let (path, name) = (format!("measured.{i}"), entry.channel.name());
            if self.measured.iter().take(i).any(|other| other.channel == entry.channel) {
                let expected = "a channel that no other entry has".to_owned();
                all.push((format!("{path}.channel"), format!("`{name}`"), expected));
            }
            match self.quantity(entry) {
                Ok(_) => {}
                Err(names) if names.is_empty() => {
                    let expected = "a channel of which the mechanism has a body, drive or joint".to_owned();
                    all.push((format!("{path}.channel"), format!("`{name}`"), expected));
                }
                Err(names) => {
                    let expected = format!("one of {}", names.join(", "));
                    all.push((format!("{path}.of"), format!("`{}`", entry.of), expected));
                }
            }
        }
        if self.measured.is_empty() {
            return;
        }
        for channel in self.common.sensors.keys() {
            if !self.measured.iter().any(|entry| entry.channel == *channel) {
                let expected = "a channel of `[[measured]]`".to_owned();
                all.push((format!("sensors.{channel}"), "no measured channel".into(), expected));
            }
        }
    }
}
