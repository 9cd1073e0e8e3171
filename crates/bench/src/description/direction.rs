//! Direction of an axis' simulation: roles of the channels if the motion is simulated.

use super::{AxisKind, Drive, DriveInput, FrictionRig, Range, Simulated};
use crate::schema::TINY;
use crate::signals::{Channel, Role};

impl FrictionRig {
    /// The drive of a simulated motion; none if the motion is the input.
    pub fn forward(&self) -> Option<&Drive> {
        self.drive.as_ref().filter(|drive| drive.simulates == Simulated::Motion)
    }

    /// Input channel of a simulated motion; none if the motion is the input.
    pub(crate) fn input_channel(&self) -> Option<Channel> {
        Some(match (self.forward()?.input, self.axis.kind) {
            (DriveInput::Effort, _) => self.channels().2,
            (DriveInput::Voltage, _) => Channel::DriveVoltage,
            (DriveInput::Order, AxisKind::Rotary) => Channel::OrderedAngle,
            (DriveInput::Order, AxisKind::Linear) => Channel::OrderedPosition,
        })
    }

    /// Role of a channel: that of the motion and of the drive depends on the direction.
    pub(super) fn role_of(&self, channel: Channel) -> Role {
        let Some(drive) = self.forward() else { return channel.role() };
        let (position, speed, effort) = self.channels();
        if channel == position || channel == speed {
            Role::Output
        } else if Some(channel) == self.input_channel() {
            Role::Input
        } else if channel == effort || channel == Channel::DriveVoltage {
            // Beside a voltage, a measured effort is an output; beside an effort, a voltage has no
            // part in the simulation.
            if drive.input == DriveInput::Effort { Role::Input } else { Role::Output }
        } else {
            channel.role()
        }
    }

    /// Returns whether a simulated motion has a channel as an output.
    pub(super) fn simulates_forward(&self, channel: Channel) -> bool {
        let is_output = self.role_of(channel) == Role::Output;
        let (position, speed, effort) = self.channels();
        is_output
            && [position, speed, effort, Channel::DriveVoltage, Channel::FrictionTorque].contains(&channel)
    }

    /// Range of the inertia: a motion needs one.
    pub(super) fn inertia_range(&self) -> Range {
        let min = if self.forward().is_some() { TINY } else { 0.0 };
        ("axis.inertia", self.axis.inertia, min, 1e9)
    }
}
