//! Self-test while the controller works: checksums of the built-in images, and known inputs through
//! the networks.
//!
//! A round feeds the image of one bearing in pieces of [`CHUNK`] bytes to a CRC-32 and then
//! [`SAMPLES`] samples to its networks. The next round takes the other bearing. The first results
//! of a bearing are its reference: the checksum proves the weights, so a later difference is a bit
//! that changed in RAM, flash or core. Tests on the emulated core prove that the results are
//! correct at first. A failed test stays failed: the supervisor misses its check-in and the
//! controller restarts. The store checks images that arrived over the link.
//!
//! A step is at most one sample through the networks, some 6,000 instructions, and may be
//! interrupted at any point.

use inference::{BearingMaterial, Model, Pair, Sample, shipped};
use link::crc32::Digest;

/// Bytes of an image per step.
pub(crate) const CHUNK: usize = 64;
/// Samples of a round: enough to replace the history of either network once.
const SAMPLES: u32 = 64;

/// Result of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Progress {
    /// The round has not ended.
    Working,
    /// A round ended without a difference.
    Passed,
    /// There was a difference; permanent.
    Failed,
}

/// Progress of a round.
#[expect(clippy::large_enum_variant, reason = "the controller has no heap to put the networks in")]
enum Stage {
    Image { left: &'static [u8], sum: Digest },
    Networks { pair: Pair<'static>, next: u32, sum: Digest },
    Failed,
}

/// The self-test.
pub(crate) struct SelfTest {
    bearing: BearingMaterial,
    stage: Stage,
    references: [Option<u32>; BearingMaterial::COUNT],
}

impl Default for SelfTest {
    fn default() -> Self {
        Self::new()
    }
}

impl SelfTest {
    /// Creates a self-test that starts with the first bearing.
    #[must_use]
    pub(crate) fn new() -> Self {
        let [bearing, ..] = BearingMaterial::ALL;
        Self { bearing, stage: first(bearing), references: [None; BearingMaterial::COUNT] }
    }

    /// Runs one step.
    pub(crate) fn step(&mut self) -> Progress {
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
        if sum.value() != u32::from_le_bytes(*expected) {
            return Progress::Failed;
        }
        let Ok(model) = Model::load(shipped(self.bearing)) else { return Progress::Failed };
        self.stage = Stage::Networks { pair: Pair::new(model), next: 0, sum: Digest::default() };
        Progress::Working
    }

    fn end_of_round(&mut self) -> Progress {
        let stage = core::mem::replace(&mut self.stage, Stage::Failed);
        let Stage::Networks { sum, .. } = stage else { return Progress::Failed };
        let found = sum.value();
        let code = self.bearing.code();
        let Some(reference) = self.references.get_mut(usize::from(code)) else { return Progress::Failed };
        if *reference.get_or_insert(found) != found {
            return Progress::Failed;
        }
        let [first_bearing, ..] = BearingMaterial::ALL;
        self.bearing = BearingMaterial::from_code(code.wrapping_add(1)).unwrap_or(first_bearing);
        self.stage = first(self.bearing);
        Progress::Passed
    }
}

fn first(bearing: BearingMaterial) -> Stage {
    Stage::Image { left: shipped(bearing), sum: Digest::default() }
}

/// Returns a known input: contacts of up to 0.19 mm and gaps, at speeds in both directions.
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
    fn intact_networks_pass_every_round() {
        let mut test = SelfTest::new();
        for _ in 0..3 * BearingMaterial::COUNT {
            assert_eq!(round(&mut test), Progress::Passed);
        }
        assert!(test.references.iter().all(Option::is_some));
        assert_ne!(test.references[0], test.references[1]);
    }

    #[test]
    fn the_known_inputs_make_the_networks_answer() {
        let mut pair: Pair<'_> = Pair::new(Model::load(shipped(BearingMaterial::Babbitt)).unwrap());
        let forces: Vec<_> = (0..SAMPLES).map(|index| pair.step(&sample(index)).normal_force_mn).collect();
        assert!(forces.iter().filter(|&&force| force > 0).count() > 20, "{forces:?}");
        assert!(forces.contains(&0), "some without contact: {forces:?}");
    }

    #[test]
    fn a_result_that_differs_from_the_first_fails_permanently() {
        let mut test = SelfTest::new();
        for _ in BearingMaterial::ALL {
            assert_eq!(round(&mut test), Progress::Passed);
        }
        test.references[0] = test.references[0].map(|reference| reference ^ 1 << 9);
        for _ in 0..3 {
            assert_eq!(round(&mut test), Progress::Failed);
        }
    }

    #[test]
    fn a_flipped_bit_of_an_image_fails() {
        let image = shipped(BearingMaterial::Babbitt);
        for at in [0, image.len() / 2, image.len() - 1] {
            let mut copy = image.to_vec();
            copy[at] ^= 4;
            let mut test = SelfTest::new();
            test.stage = Stage::Image { left: copy.leak(), sum: Digest::default() };
            assert_eq!(round(&mut test), Progress::Failed, "byte {at}");
        }
    }
}
