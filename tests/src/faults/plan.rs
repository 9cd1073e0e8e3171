//! Assignment of faults to numbers.
//!
//! Forty numbers are a round. Faults of memory are more frequent, because most of the controller is
//! memory. All other properties of a fault are drawn from the random stream of its number.

use super::image::{Image, length, pick};
use super::scenario::{FAULTS_BEFORE, FAULTS_FROM};
use super::stream;
use crate::random::SplitMix64;
use serde::{Deserialize, Serialize};

/// An executed instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    /// Address.
    pub address: u32,
    /// Stack pointer before the instruction.
    pub stack: u32,
    /// Earlier executions of the same address in this trace.
    pub before: u32,
}

/// Kind of fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Bit flip in the networks in use, in flash.
    Weights,
    /// Bit flip in code or constants, in flash; half of them in code that a sample executes.
    Code,
    /// Bit flip in the controller's static memory.
    State,
    /// Permanent step of a journal probe that is below the threshold of the checks on positions.
    SensorSmallOffset,
    /// Bit flip on the stack, before an instruction in the middle of a tick.
    Stack,
    /// Reset of the machine.
    Reset,
    /// Bit flips in a frame on the line.
    FrameCorrupted,
    /// Lost frames.
    FrameDropped,
    /// Repeated frame.
    FrameRepeated,
    /// Frame that arrives several places late.
    FrameDelayed,
    /// Two frames exchanged.
    FramesReordered,
    /// Sensor that repeats one code for long.
    SensorStuck,
    /// Permanent step that the machine cannot make.
    SensorJump,
    /// Single sample far off.
    SensorSpike,
    /// Sensor without a value.
    SensorMissing,
    /// Permanent step that the machine could make within a sample.
    SensorOffset,
    /// Error that grows with time.
    SensorDrift,
    /// Additional noise.
    SensorNoise,
    /// Sensor at the end of its range.
    SensorSaturated,
    /// Missing readings for a while: the driver repeats the last one and marks it.
    SensorDropOut,
}

impl Kind {
    /// All kinds.
    pub const ALL: [Self; 20] = [
        Self::Weights,
        Self::Code,
        Self::State,
        Self::SensorSmallOffset,
        Self::Stack,
        Self::Reset,
        Self::FrameCorrupted,
        Self::FrameDropped,
        Self::FrameRepeated,
        Self::FrameDelayed,
        Self::FramesReordered,
        Self::SensorStuck,
        Self::SensorJump,
        Self::SensorSpike,
        Self::SensorMissing,
        Self::SensorOffset,
        Self::SensorDrift,
        Self::SensorNoise,
        Self::SensorSaturated,
        Self::SensorDropOut,
    ];

    /// Returns the number of faults of this kind in a round.
    const fn share(self) -> u64 {
        match self {
            Self::Weights | Self::Stack => 4,
            Self::Code => 8,
            Self::State => 8,
            _ => 1,
        }
    }

    /// Returns the kind of a fault number.
    #[must_use]
    pub(crate) fn for_number(number: u64) -> Self {
        let round = Self::ALL.iter().map(|kind| kind.share()).sum::<u64>();
        // The factor is coprime to the round, so it mixes the kinds.
        let mut place = number.wrapping_mul(7) % round;
        for kind in Self::ALL {
            if place < kind.share() {
                return kind;
            }
            place -= kind.share();
        }
        Self::Reset
    }

    /// Returns whether a sensor fails.
    #[must_use]
    pub(crate) const fn is_sensor_fault(self) -> bool {
        matches!(
            self,
            Self::SensorStuck
                | Self::SensorSmallOffset
                | Self::SensorJump
                | Self::SensorSpike
                | Self::SensorMissing
                | Self::SensorOffset
                | Self::SensorDrift
                | Self::SensorNoise
                | Self::SensorSaturated
                | Self::SensorDropOut
        )
    }

    /// Returns the name in kebab-case.
    #[must_use]
    pub fn name(self) -> String {
        serde_json::to_value(self)
            .ok()
            .and_then(|value| value.as_str().map(str::to_owned))
            .unwrap_or_default()
    }
}

/// Action that injects a fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// Flips a bit in memory.
    Flip {
        /// Address of the byte.
        address: u32,
        /// Number of the bit.
        bit: u8,
        /// Instruction before which the bit flips; `None`: between two samples.
        during: Option<Step>,
    },
    /// Resets the machine between two samples.
    Reset,
    /// Changes the bytes or the samples; see [`super::streams`].
    Stream,
}

/// A fault of the campaign.
#[derive(Clone, Debug)]
pub struct Fault {
    /// Number in the campaign.
    pub number: u64,
    /// Kind.
    pub kind: Kind,
    /// Sample of the fault, or the one after it.
    pub sample: usize,
    /// Action.
    pub action: Action,
    /// Random stream for further properties.
    pub random: SplitMix64,
}

impl Fault {
    /// Returns the fault of a number.
    #[must_use]
    pub fn new(seed: u64, number: u64, image: &Image, trace: &[Step]) -> Self {
        let mut random = stream(seed, number);
        let kind = Kind::for_number(number);
        let sample = FAULTS_FROM + random.below((FAULTS_BEFORE - FAULTS_FROM) as u32) as usize;
        let step = trace.get(random.below(trace.len() as u32) as usize).copied();
        let bit = random.below(8) as u8;
        let executed = random.bits().is_multiple_of(2);
        let place = random.bits();
        let within = |ranges: &[std::ops::Range<u32>]| {
            let bytes = u64::from(length(ranges)).max(1);
            pick(ranges, (place % bytes) as u32).unwrap_or_default()
        };
        let flip = |address, during| Action::Flip { address, bit, during };
        let action = match kind {
            Kind::Weights => flip(within(std::slice::from_ref(&image.weights)), None),
            Kind::Code => match step {
                // Both halfwords of a long instruction; after a short one, the next is likely to be
                // executed, too.
                Some(step) if executed => flip(step.address + (place % 4) as u32, None),
                _ => flip(within(&image.code), None),
            },
            // Three of four in the session, which the estimates depend on.
            Kind::State if !random.bits().is_multiple_of(4) => {
                flip(within(std::slice::from_ref(&image.session)), None)
            }
            Kind::State => flip(within(&image.other_state), None),
            Kind::Stack => {
                let bottom = step.map_or(image.stack_top, |step| step.stack);
                // Half of them in the frames of the running functions.
                let top =
                    if executed { image.stack_top.min(bottom.saturating_add(512)) } else { image.stack_top };
                flip(within(std::slice::from_ref(&(bottom..top))), step)
            }
            Kind::Reset => Action::Reset,
            _ => Action::Stream,
        };
        Self { number, kind, sample, action, random }
    }

    /// Returns the fault of a number if it is a sensor fault, which needs no image.
    #[must_use]
    pub fn for_sensor(seed: u64, number: u64) -> Option<Self> {
        Kind::for_number(number).is_sensor_fault().then(|| Self::new(seed, number, &Image::default(), &[]))
    }

    /// Describes place and time of the fault.
    #[must_use]
    pub fn description(&self) -> String {
        match self.action {
            Action::Flip { address, bit, during: None } => {
                format!("bit {bit} of {address:#010x} before sample {}", self.sample)
            }
            Action::Flip { address, bit, during: Some(step) } => format!(
                "bit {bit} of {address:#010x} in sample {}, before {:#010x}, pass {}",
                self.sample,
                step.address,
                step.before + 1
            ),
            _ => format!("sample {}", self.sample),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    #[test]
    fn a_round_has_every_kind_as_often_as_its_share() {
        let round = Kind::ALL.iter().map(|kind| kind.share()).sum::<u64>();
        let mut counts = BTreeMap::new();
        for number in 0..round {
            *counts.entry(Kind::for_number(number)).or_insert(0) += 1;
        }
        assert_eq!(counts.len(), Kind::ALL.len());
        for (kind, count) in counts {
            assert_eq!(count, kind.share(), "{kind:?}");
        }
    }

    #[test]
    fn names_are_words_with_hyphens() {
        assert_eq!(Kind::SensorDropOut.name(), "sensor-drop-out");
    }
}
