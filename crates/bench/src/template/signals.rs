//! Plants of a template, and their signals with the columns that may hold them.

use super::columns::{Candidate, Chosen, choose};
use super::names::{MotionKind, Quantity};
use crate::description::{AxisKind, FrictionRig, TransmissionBench};
use crate::log::TIME;
use crate::signals::Channel;

/// Plant of a template.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TemplatePlant {
    /// A single driven axis.
    Axis(AxisKind),
    /// The transmission bench.
    Transmission,
}

impl TemplatePlant {
    /// Plants with their names.
    pub const ALL: &[(&str, Self)] = &[
        ("linear-axis", Self::Axis(AxisKind::Linear)),
        ("rotary-axis", Self::Axis(AxisKind::Rotary)),
        ("transmission-bench", Self::Transmission),
    ];

    /// Name of the plant in a description.
    pub(super) const fn plant(self) -> &'static str {
        match self {
            Self::Axis(_) => FrictionRig::PLANT,
            Self::Transmission => TransmissionBench::PLANT,
        }
    }
}

/// A signal of the plant and the column that may hold it.
pub(super) struct Signal<'a> {
    pub(super) name: &'static str,
    /// True if the plant cannot be simulated or compared without it.
    pub(super) is_needed: bool,
    pub(super) chosen: Option<Chosen<'a>>,
}

/// Signals of a plant with their columns.
pub(super) fn signals<'a>(candidates: &[Candidate<'a>], plant: TemplatePlant) -> Vec<Signal<'a>> {
    let time = (TIME, Some(Quantity::Time), true);
    let (kind, wanted) = match plant {
        TemplatePlant::Axis(kind) => {
            let [position, speed, effort] = match kind {
                AxisKind::Rotary => [Channel::SpindleAngle, Channel::SpindleSpeed, Channel::DriveTorque],
                AxisKind::Linear => [Channel::Position, Channel::Velocity, Channel::DriveForce],
            };
            let kind = match kind {
                AxisKind::Rotary => MotionKind::Rotary,
                AxisKind::Linear => MotionKind::Linear,
            };
            let wanted = vec![
                time,
                (position.name(), Some(Quantity::Position), true),
                (speed.name(), Some(Quantity::Speed), false),
                (Channel::LoadForce.name(), Some(Quantity::Load), false),
                (effort.name(), Some(Quantity::Effort), true),
            ];
            (Some(kind), wanted)
        }
        TemplatePlant::Transmission => {
            let is_of_axis = |c: &&Channel| {
                use Channel::{
                    BearingTemperature, DriveTorque, DriveVoltage, OrderedAngle, OrderedPosition, Position,
                    SpindleAngle, SpindleSpeed, Velocity,
                };
                matches!(
                    c,
                    SpindleAngle
                        | SpindleSpeed
                        | Position
                        | Velocity
                        | OrderedAngle
                        | OrderedPosition
                        | DriveVoltage
                        | DriveTorque
                        | BearingTemperature
                )
            };
            let is_needed = |c: &Channel| matches!(c, Channel::DriveDisplacement | Channel::LoadForce);
            let channels = Channel::ALL.iter().filter(|c| !is_of_axis(c));
            let wanted = std::iter::once(time).chain(channels.map(|c| (c.name(), None, is_needed(c))));
            (None, wanted.collect())
        }
    };
    let signal = |(name, quantity, is_needed): (&'static str, Option<Quantity>, bool)| Signal {
        name,
        is_needed,
        chosen: choose(candidates, name, quantity, kind),
    };
    wanted.into_iter().map(signal).collect()
}
