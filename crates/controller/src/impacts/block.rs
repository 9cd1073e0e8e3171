//! Summary of the estimates between two that are sent.

use link::{BlockSummary, EstimateFrame};

use crate::integrity::{Checksum, Guarded, Words};
use inference::Flags;

impl Words for BlockSummary {
    #[inline]
    fn add_to(&self, sum: &mut impl Checksum) {
        self.words().iter().for_each(|&word| sum.add_word(word));
    }
}

/// Block of estimates that is being summarised; empty with 0 samples.
#[derive(Clone, Debug, Default)]
pub(crate) struct Block(Guarded<BlockSummary>);

impl Block {
    /// Adds an estimate and returns the summary so far. A corrupted summary starts anew, and its
    /// flags contain `CORRUPTED`.
    #[inline]
    pub(crate) fn add(&mut self, estimate: &EstimateFrame) -> BlockSummary {
        let is_corrupted = self.0.is_corrupted();
        let block = self.0.value_mut();
        if is_corrupted {
            *block = BlockSummary { flags: Flags::CORRUPTED.bits(), ..BlockSummary::default() };
        }
        let (force_n, is_first) = (estimate.normal_force_n, block.samples == 0);
        let is_max = is_first | (force_n > block.max_force_n);
        let is_min = is_first | (force_n < block.min_force_n);
        block.max_age = if is_max { 0 } else { block.max_age.saturating_add(1) };
        block.max_force_n = if is_max { force_n } else { block.max_force_n };
        block.min_force_n = if is_min { force_n } else { block.min_force_n };
        block.flags |= estimate.flags;
        block.samples = block.samples.saturating_add(1);
        let summary = *block;
        self.0.seal(false);
        summary
    }

    /// Begins the next block.
    #[inline]
    pub(crate) fn restart(&mut self) {
        self.0 = Guarded::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn estimate(normal_force_n: f32, flags: u32) -> EstimateFrame {
        EstimateFrame { normal_force_n, flags, ..EstimateFrame::default() }
    }

    proptest! {
        #[test]
        fn the_summary_equals_that_of_all_estimates_at_once(
            samples in prop::collection::vec((0.0_f32..1e4, any::<u32>()), 1..200),
        ) {
            let mut block = Block::default();
            let summaries = samples.iter().map(|&(force, flags)| block.add(&estimate(force, flags)));
            let last = summaries.last().unwrap();
            let forces = || samples.iter().map(|(force, _)| *force);
            prop_assert_eq!(last.max_force_n, forces().fold(0.0, f32::max));
            prop_assert_eq!(last.min_force_n, forces().fold(f32::INFINITY, f32::min));
            prop_assert_eq!(last.flags, samples.iter().fold(0, |all, (_, flags)| all | flags));
            prop_assert_eq!(usize::from(last.samples), samples.len());
            let age = usize::from(last.max_age);
            prop_assert_eq!(samples[samples.len() - 1 - age].0, last.max_force_n);
        }
    }

    #[test]
    fn the_next_block_does_not_contain_the_last_one() {
        let mut block = Block::default();
        block.add(&estimate(5.0, 1));
        block.restart();
        let summary = block.add(&estimate(3.0, 2));
        let expected = BlockSummary { max_force_n: 3.0, min_force_n: 3.0, flags: 2, samples: 1, max_age: 0 };
        assert_eq!(summary, expected);
    }

    #[test]
    fn a_flipped_bit_of_the_block_is_flagged() {
        for bit in 0..32 {
            let mut block = Block::default();
            block.add(&estimate(5.0, 0));
            let value = block.0.value_mut();
            value.max_force_n = f32::from_bits(value.max_force_n.to_bits() ^ 1 << bit);
            let summary = block.add(&estimate(3.0, 2));
            assert_eq!((summary.max_force_n, summary.samples), (3.0, 1));
            assert!(Flags::from_bits(summary.flags).contains(Flags::CORRUPTED));
        }
    }
}
