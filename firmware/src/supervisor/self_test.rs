//! The self-test that runs while the controller waits: the built-in images' check sums, and known inputs through the networks.
//!
//! A round takes one bearing's image in [`CHUNK`]-byte pieces through CRC-32 and then [`SAMPLES`] samples through its networks; the next
//! round takes the other bearing. The first results of a bearing are its reference: the check sum vouches for the weights, so any later
//! difference is a bit that changed in RAM, flash or core. (That the results are right in the first place is what the tests on the emulated
//! core are for.) A failed test never passes again: the supervisor misses it and the controller restarts.
//! Images that came over the link are the store's to check.
//!
//! A step is at most one sample through the networks, some 6,000 instructions, and may be interrupted anywhere.

use inference::{Bearing, Model, Pair, Sample, shipped};

/// Bytes of an image taken in one step.
pub const CHUNK: usize = 64;
/// Samples of a round: enough for the history of either network to be replaced once.
pub const SAMPLES: u32 = 64;

static CRC: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);

/// What came of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// More steps to go.
    Working,
    /// A round ended and everything was as it should be.
    Passed,
    /// Something was not; from now on for ever.
    Failed,
}

/// Where a round stands.
#[expect(clippy::large_enum_variant, reason = "the controller has no heap to put the networks in")]
enum Stage {
    Image { left: &'static [u8], sum: crc::Digest<'static, u32> },
    Networks { pair: Pair<'static>, next: u32, sum: crc::Digest<'static, u32> },
    Failed,
}

/// The self-test.
pub struct SelfTest {
    bearing: Bearing,
    stage: Stage,
    references: [Option<u32>; 2],
}

impl Default for SelfTest {
    fn default() -> Self {
        Self::new()
    }
}

impl SelfTest {
    /// Starts with the first bearing.
    #[must_use]
    pub fn new() -> Self {
        Self { bearing: Bearing::Babbitt, stage: first(Bearing::Babbitt), references: [None; 2] }
    }

    /// Goes on for one step.
    pub fn step(&mut self) -> Progress {
        let progress = match &mut self.stage {
            Stage::Failed => Progress::Failed,
            Stage::Image { left, sum } => {
                let image = *left;
                match image.split_at_checked(CHUNK) {
                    Some((chunk, rest)) if rest.len() >= 4 => {
                        sum.update(chunk);
                        *left = rest;
                        Progress::Working
                    }
                    _ => self.end_of_image(image),
                }
            }
            Stage::Networks { pair, next, sum } => {
                let estimate = pair.step(&sample(*next));
                sum.update(&estimate.normal_force_mn.to_le_bytes());
                sum.update(&estimate.friction_force_mn.to_le_bytes());
                *next = next.wrapping_add(1);
                if *next < SAMPLES { Progress::Working } else { self.end_of_round() }
            }
        };
        if progress == Progress::Failed {
            self.stage = Stage::Failed;
        }
        progress
    }

    fn end_of_image(&mut self, last: &[u8]) -> Progress {
        let stage = core::mem::replace(&mut self.stage, Stage::Failed);
        let Stage::Image { mut sum, .. } = stage else { return Progress::Failed };
        let Some((rest, expected)) = last.split_last_chunk::<4>() else { return Progress::Failed };
        sum.update(rest);
        if sum.finalize() != u32::from_le_bytes(*expected) {
            return Progress::Failed;
        }
        let Ok(model) = Model::load(shipped(self.bearing)) else { return Progress::Failed };
        self.stage = Stage::Networks { pair: Pair::new(model), next: 0, sum: CRC.digest() };
        Progress::Working
    }

    fn end_of_round(&mut self) -> Progress {
        let stage = core::mem::replace(&mut self.stage, Stage::Failed);
        let Stage::Networks { sum, .. } = stage else { return Progress::Failed };
        let found = sum.finalize();
        let [babbitt, plastic] = &mut self.references;
        let (reference, next) = match self.bearing {
            Bearing::Babbitt => (babbitt, Bearing::Plastic),
            Bearing::Plastic => (plastic, Bearing::Babbitt),
        };
        if *reference.get_or_insert(found) != found {
            return Progress::Failed;
        }
        self.bearing = next;
        self.stage = first(next);
        Progress::Passed
    }
}

fn first(bearing: Bearing) -> Stage {
    Stage::Image { left: shipped(bearing), sum: CRC.digest() }
}

/// A known input: contacts of up to 0.19 mm and gaps, at speeds either way.
fn sample(index: u32) -> Sample {
    let swing = i32::from(index.wrapping_mul(37).to_le_bytes()[0]).wrapping_sub(128);
    Sample {
        radial_clearance_nm: 500_000,
        deformation_pm: swing.wrapping_mul(1_500_000),
        deformation_rate_nm_s: swing.wrapping_mul(-100_000),
        approach_speed_nm_s: 50_000_000,
        sliding_speed_nm_s: swing.wrapping_mul(300_000),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn round(test: &mut SelfTest) -> Progress {
        (0..10_000).map(|_| test.step()).find(|progress| *progress != Progress::Working).unwrap()
    }

    #[test]
    fn sound_networks_pass_round_after_round() {
        let mut test = SelfTest::new();
        for _ in 0..6 {
            assert_eq!(round(&mut test), Progress::Passed);
        }
        assert!(test.references.iter().all(Option::is_some));
        assert_ne!(test.references[0], test.references[1]);
    }

    #[test]
    fn the_known_inputs_make_the_networks_answer() {
        let mut pair: Pair<'_> = Pair::new(Model::load(shipped(Bearing::Babbitt)).unwrap());
        let forces: Vec<_> = (0..SAMPLES).map(|index| pair.step(&sample(index)).normal_force_mn).collect();
        assert!(forces.iter().filter(|&&force| force > 0).count() > 20, "{forces:?}");
        assert!(forces.contains(&0), "some without contact: {forces:?}");
    }

    #[test]
    fn another_result_than_the_first_fails_for_ever() {
        let mut test = SelfTest::new();
        assert_eq!(round(&mut test), Progress::Passed);
        assert_eq!(round(&mut test), Progress::Passed);
        test.references[0] = test.references[0].map(|reference| reference ^ 1 << 9);
        for _ in 0..3 {
            assert_eq!(round(&mut test), Progress::Failed);
        }
    }

    #[test]
    fn a_flipped_bit_of_an_image_fails() {
        let image = shipped(Bearing::Babbitt);
        for at in [0, image.len() / 2, image.len() - 1] {
            let mut copy = image.to_vec();
            copy[at] ^= 4;
            let mut test = SelfTest::new();
            test.stage = Stage::Image { left: copy.leak(), sum: CRC.digest() };
            assert_eq!(round(&mut test), Progress::Failed, "byte {at}");
        }
    }
}
