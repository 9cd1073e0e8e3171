//! Summary of the estimates between two that are sent.

use link::{BlockSummary, EstimateFrame};

use crate::integrity::{Guarded, words};
use inference::Flags;

words!(BlockSummary { number, max_force_n, min_force_n, flags, samples, max_age });

/// Block of estimates that is being summarised; empty with 0 samples.
#[derive(Clone, Debug, Default)]
pub(crate) struct Block(Guarded<BlockSummary>);

impl Block {
    /// Adds an estimate. A corrupted summary starts anew, and its flags contain `CORRUPTED`.
    #[inline]
    pub(crate) fn add(&mut self, estimate: &EstimateFrame) {
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
        self.0.seal(false);
    }

    /// Ends the block at the sent estimate with this number and begins the next one. The summary
    /// stays guarded until it is sent.
    pub(crate) fn take(&mut self, number: u32) -> Guarded<BlockSummary> {
        let mut ended = core::mem::take(&mut self.0);
        let is_corrupted = ended.is_corrupted();
        ended.value_mut().number = number;
        ended.seal(is_corrupted);
        ended
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
            samples.iter().for_each(|&(force, flags)| block.add(&estimate(force, flags)));
            let (last, is_corrupted) = block.take(7).load();
            prop_assert!(!is_corrupted && last.number == 7);
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
        block.take(0);
        block.add(&estimate(3.0, 2));
        let (number, samples, max_age) = (1, 1, 0);
        let expected =
            BlockSummary { number, max_force_n: 3.0, min_force_n: 3.0, flags: 2, samples, max_age };
        assert_eq!(block.take(1).load(), (expected, false));
    }

    #[test]
    fn a_flipped_bit_of_the_block_is_flagged() {
        for bit in 0..32 {
            let mut block = Block::default();
            block.add(&estimate(5.0, 0));
            let value = block.0.value_mut();
            value.max_force_n = f32::from_bits(value.max_force_n.to_bits() ^ 1 << bit);
            assert!(block.clone().take(0).load().1, "a block that is sent corrupted");
            block.add(&estimate(3.0, 2));
            let (summary, _) = block.take(0).load();
            assert_eq!((summary.max_force_n, summary.samples), (3.0, 1));
            assert!(Flags::from_bits(summary.flags).contains(Flags::CORRUPTED));
        }
    }
}
