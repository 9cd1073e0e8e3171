//! Which fault a number stands for.
//!
//! Forty numbers are a round: memory more often than the rest, because there is more of it. Everything else about a fault is drawn from the stream
//! of its number.

use super::Random;
use super::image::{Image, length, pick};
use super::stage::{FAULTS_BEFORE, FAULTS_FROM};
use super::trace::Step;
use serde::{Deserialize, Serialize};

/// What is disturbed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// A bit of the networks in use, in flash.
    Weights,
    /// A bit of code or constants, in flash; half of them in what a sample carries out.
    Code,
    /// A bit of the controller's static memory.
    State,
    /// A bit of the stack, before an instruction in the middle of a tick.
    Stack,
    /// A reset of the machine.
    Reset,
    /// Bits of a frame on the line.
    FrameCorrupted,
    /// A frame lost.
    FrameDropped,
    /// A frame twice.
    FrameRepeated,
    /// A frame several places late.
    FrameDelayed,
    /// Two frames exchanged.
    FramesReordered,
    /// One code for long.
    SensorStuck,
    /// A step that the machine cannot make, and stays.
    SensorJump,
    /// One sample far off.
    SensorSpike,
    /// No number.
    SensorMissing,
    /// A step within what the machine could move in a sample, and stays.
    SensorOffset,
    /// An error that grows.
    SensorDrift,
    /// Noise.
    SensorNoise,
    /// The end of the range.
    SensorSaturated,
    /// Readings that do not come for a while: the last one, marked by its driver.
    SensorDropOut,
}

impl Kind {
    /// Every kind.
    pub const ALL: [Self; 19] = [
        Self::Weights,
        Self::Code,
        Self::State,
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

    /// How often it comes in a round.
    const fn share(self) -> u64 {
        match self {
            Self::Weights | Self::Stack => 4,
            Self::Code => 8,
            Self::State => 9,
            _ => 1,
        }
    }

    /// The kind of a number.
    #[must_use]
    pub fn of(number: u64) -> Self {
        let round = Self::ALL.iter().map(|kind| kind.share()).sum::<u64>();
        // A step prime to the round mixes the kinds.
        let mut place = number.wrapping_mul(7) % round;
        for kind in Self::ALL {
            if place < kind.share() {
                return kind;
            }
            place -= kind.share();
        }
        Self::Reset
    }

    /// Whether it is a sensor that goes wrong.
    #[must_use]
    pub const fn is_of_sensor(self) -> bool {
        matches!(
            self,
            Self::SensorStuck
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

    /// Its name.
    #[must_use]
    pub fn name(self) -> String {
        serde_json::to_value(self)
            .ok()
            .and_then(|value| value.as_str().map(str::to_owned))
            .unwrap_or_default()
    }
}

/// What happens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// A bit in memory flips.
    Flip {
        /// Where.
        address: u32,
        /// Which.
        bit: u8,
        /// Before which instruction; none for between two samples.
        during: Option<Step>,
    },
    /// The machine is reset between two samples.
    Reset,
    /// The bytes or the samples themselves are disturbed; see [`super::streams`].
    Stream,
}

/// A fault.
#[derive(Clone, Debug)]
pub struct Fault {
    /// Its number in the campaign.
    pub number: u64,
    /// What is disturbed.
    pub kind: Kind,
    /// The sample before which, or in which.
    pub sample: usize,
    /// What happens.
    pub action: Action,
    /// For everything else that is drawn.
    pub random: Random,
}

impl Fault {
    /// The fault of a number.
    #[must_use]
    pub fn new(seed: u64, number: u64, image: &Image, trace: &[Step]) -> Self {
        let mut random = Random::new(seed, number);
        let kind = Kind::of(number);
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
                // Both halfwords of what may be one instruction; behind a short one comes what is likely to be carried out, too.
                Some(step) if executed => flip(step.address + (place % 4) as u32, None),
                _ => flip(within(&image.code), None),
            },
            // Three in four in the session, which is what the estimates rest on.
            Kind::State if !random.bits().is_multiple_of(4) => {
                flip(within(std::slice::from_ref(&image.session)), None)
            }
            Kind::State => flip(within(&image.other_state), None),
            Kind::Stack => {
                let bottom = step.map_or(image.stack_top, |step| step.stack);
                // Half of them in the frames of the functions that are at work.
                let top =
                    if executed { image.stack_top.min(bottom.saturating_add(512)) } else { image.stack_top };
                flip(within(std::slice::from_ref(&(bottom..top))), step)
            }
            Kind::Reset => Action::Reset,
            _ => Action::Stream,
        };
        Self { number, kind, sample, action, random }
    }

    /// The fault of a number if it is one of a sensor: that hangs on no image.
    #[must_use]
    pub fn of_sensor(seed: u64, number: u64) -> Option<Self> {
        Kind::of(number).is_of_sensor().then(|| Self::new(seed, number, &Image::default(), &[]))
    }

    /// What it was, for a list.
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
            *counts.entry(Kind::of(number)).or_insert(0) += 1;
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
