//! Faults of samples and of frames: the disturbed input of the controller.

use super::CampaignError;
use super::plan::{Fault, Kind};
use crate::random::SplitMix64;
use link::track::{SensorChannel, SensorStatus};
use link::{MAX_FRAME, SensorFrame, ToController, encode};

/// Maximum length of a temporary sensor fault, in samples.
const MAX_FAULT_SAMPLES: u32 = 400;

/// Returns the samples with the fault.
#[must_use]
pub fn disturbed(fault: &Fault, frames: &[SensorFrame]) -> Vec<(SensorFrame, SensorStatus)> {
    let mut random = fault.random.clone();
    let mut samples: Vec<_> = frames.iter().map(|frame| (*frame, SensorStatus::GOOD)).collect();
    let begin = fault.sample;
    let channel = channel_of(fault.kind, &mut random);
    let last = frames.get(begin.saturating_sub(1)).map_or(0, |frame| value(frame, channel));
    let sign = if random.bits().is_multiple_of(2) { 1.0 } else { -1.0 };
    let lasting = 1 + random.below(MAX_FAULT_SAMPLES) as usize;
    let amount = sign * magnitude(fault.kind, channel, &mut random);
    for (after, (frame, status)) in samples.iter_mut().skip(begin).enumerate() {
        let lasts = after < lasting;
        let to = value_mut(frame, channel);
        let off = |error: f64| to.wrapping_add(error.round() as i64 as i32);
        match fault.kind {
            Kind::SensorStuck => *to = last,
            Kind::SensorJump | Kind::SensorOffset | Kind::SensorSmallOffset => *to = off(amount),
            Kind::SensorSpike if after == 0 => *to = off(amount),
            Kind::SensorMissing if lasts => *to = i32::MIN,
            Kind::SensorDrift => *to = off(amount * after as f64 / 10_000.0),
            Kind::SensorNoise => *to = off(amount * about_normal(&mut random)),
            Kind::SensorSaturated if lasts => *to = amount as i32,
            Kind::SensorDropOut if lasts => {
                *to = last;
                *status = status.missing(channel);
            }
            _ => {}
        }
    }
    samples
}

/// Returns the magnitude of a sensor fault in nm, nrad or mN. Most are logarithmically uniform
/// between the limits of their kind.
fn magnitude(kind: Kind, channel: SensorChannel, random: &mut SplitMix64) -> f64 {
    let mut between = |min: f64, max: f64| min * (max / min).powf(random.unit());
    match (kind, channel) {
        (Kind::SensorJump | Kind::SensorSpike, SensorChannel::ShaftAngle) => between(12e6, 1e9),
        (Kind::SensorJump | Kind::SensorSpike, _) => between(60e3, 1e6),
        (Kind::SensorOffset, _) => between(15e3, 50e3),
        // Within the noise that the checks allow; see `docs/firmware.md`.
        (Kind::SensorSmallOffset, _) => between(1e3, 12e3),
        // Drift in one second.
        (Kind::SensorDrift, _) => between(100e3, 1e6),
        (Kind::SensorNoise, SensorChannel::ShaftAngle) => between(1e6, 20e6),
        (Kind::SensorNoise, _) => between(5e3, 50e3),
        (Kind::SensorSaturated, SensorChannel::LoadForce) => f64::from(i32::MAX),
        (Kind::SensorSaturated, _) => 2.1e6,
        _ => 0.0,
    }
}

/// Returns a nearly normal number with unit variance: the sum of twelve uniform ones.
///
/// The exact generator of the logs would change the faults of every published campaign.
fn about_normal(random: &mut SplitMix64) -> f64 {
    (0..12).map(|_| random.unit()).sum::<f64>() - 6.0
}

/// Returns the bytes of the frames with a fault of the line, one entry for each frame that is sent.
pub fn framed(fault: &Fault, samples: &[(SensorFrame, SensorStatus)]) -> Result<Vec<Vec<u8>>, CampaignError> {
    let mut random = fault.random.clone();
    let mut frames = samples.iter().map(|(frame, status)| bytes(&ToController::Sensor(*frame, *status)));
    let mut frames = frames.by_ref().collect::<Result<Vec<_>, _>>()?;
    let at = fault.sample;
    match fault.kind {
        Kind::FrameCorrupted => {
            for _ in 0..1 + random.below(8) {
                if let Some(frame) = frames.get_mut(at) {
                    let place = random.below(frame.len() as u32) as usize;
                    let bit = random.below(8);
                    if let Some(byte) = frame.get_mut(place) {
                        *byte ^= 1 << bit;
                    }
                }
            }
        }
        Kind::FrameDropped => {
            frames.drain(at..at + 1 + random.below(5) as usize);
        }
        Kind::FrameRepeated => {
            let again = frames.get(at).cloned().unwrap_or_default();
            frames.insert(at, again);
        }
        Kind::FrameDelayed => {
            let late = frames.remove(at);
            frames.insert(at + 2 + random.below(50) as usize, late);
        }
        Kind::FramesReordered => frames.swap(at, at + 1),
        _ => {}
    }
    Ok(frames)
}

/// Encodes a message.
pub fn bytes(message: &ToController) -> Result<Vec<u8>, CampaignError> {
    let mut buffer = [0; MAX_FRAME];
    encode(message, &mut buffer).map(<[u8]>::to_vec).map_err(|error| CampaignError::Unexpected {
        found: error.to_string(),
        expected: "a message that fits a frame",
    })
}

/// Draws the channel that fails. Offset and drift of the angle change no estimate, and those of the
/// load none either, so they are left out.
fn channel_of(kind: Kind, random: &mut SplitMix64) -> SensorChannel {
    let journal = [SensorChannel::JournalY, SensorChannel::JournalZ];
    let channels: &[SensorChannel] = match kind {
        Kind::SensorOffset | Kind::SensorSmallOffset | Kind::SensorDrift => &journal,
        Kind::SensorStuck | Kind::SensorJump | Kind::SensorSpike | Kind::SensorNoise => {
            &[SensorChannel::JournalY, SensorChannel::JournalZ, SensorChannel::ShaftAngle]
        }
        _ => &SensorChannel::ALL,
    };
    let place = random.below(channels.len() as u32) as usize;
    channels.get(place).copied().unwrap_or(SensorChannel::JournalY)
}

fn value(frame: &SensorFrame, channel: SensorChannel) -> i32 {
    *value_mut(&mut frame.clone(), channel)
}

const fn value_mut(frame: &mut SensorFrame, channel: SensorChannel) -> &mut i32 {
    match channel {
        SensorChannel::JournalY => &mut frame.journal_y_nm,
        SensorChannel::JournalZ => &mut frame.journal_z_nm,
        SensorChannel::ShaftAngle => &mut frame.shaft_angle_nrad,
        SensorChannel::LoadForce => &mut frame.load_force_mn,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::faults::plan::Action;

    fn fault(kind: Kind, number: u64) -> Fault {
        Fault { number, kind, sample: 20, action: Action::Stream, random: super::super::stream(3, number) }
    }

    fn frames() -> Vec<SensorFrame> {
        (0..500)
            .map(|sequence| SensorFrame {
                sequence,
                time_us: 100 * sequence,
                journal_y_nm: 7 * sequence as i32,
                journal_z_nm: -500_000 + 3 * sequence as i32,
                shaft_angle_nrad: 1_000 * sequence as i32,
                load_force_mn: 10_000_000 + sequence as i32,
            })
            .collect()
    }

    #[test]
    fn every_fault_changes_the_input_from_its_sample_on_and_nothing_before() {
        let frames = frames();
        let reference: Vec<_> = frames.iter().map(|frame| (*frame, SensorStatus::GOOD)).collect();
        let plain: Vec<_> = reference
            .iter()
            .map(|(frame, status)| bytes(&ToController::Sensor(*frame, *status)).unwrap())
            .collect();
        let streams = Kind::ALL
            .into_iter()
            .filter(|kind| kind.name().contains("frame") || kind.name().contains("sensor"));
        for kind in streams {
            for number in 0..20 {
                let fault = fault(kind, number);
                let disturbed = framed(&fault, &disturbed(&fault, &frames)).unwrap();
                assert_eq!(disturbed[..20], plain[..20], "{kind:?}");
                // An even number of flips of one bit changes nothing: rare, and harmless.
                assert!(disturbed != plain || kind == Kind::FrameCorrupted, "{kind:?} {number}");
                assert_eq!(
                    disturbed,
                    framed(&fault, &super::disturbed(&fault, &frames)).unwrap(),
                    "it repeats"
                );
            }
        }
    }

    #[test]
    fn frames_are_dropped_repeated_and_moved() {
        let frames = frames();
        let count = |kind| {
            let fault = fault(kind, 5);
            framed(&fault, &disturbed(&fault, &frames)).unwrap().len()
        };
        assert!((495..500).contains(&count(Kind::FrameDropped)));
        assert_eq!(count(Kind::FrameRepeated), 501);
        assert_eq!([Kind::FrameDelayed, Kind::FramesReordered, Kind::FrameCorrupted].map(count), [500; 3]);
    }
}
