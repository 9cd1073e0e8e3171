//! Word sum that detects bit flips in values that wait in memory.
//!
//! A tick keeps intermediate results on the stack while the networks work. A bit flip there would
//! change the forces by too little for any limit to notice.

pub use crate::kernel::read_anew;

/// Sum over words: the sum is rotated, then the word is added by exclusive or. It detects every
/// single flipped bit, in a word or in the stored sum. Two flipped bits in different words can
/// cancel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WordSum(u32);

impl WordSum {
    /// Returns the sum of some words.
    #[inline]
    #[must_use]
    pub fn from_words(words: &[u32]) -> Self {
        let mut sum = Self::default();
        words.iter().for_each(|&word| sum.add_word(word));
        sum
    }

    /// Bits by which the sum is rotated before a word is added: odd, so that the bits of
    /// neighbouring words do not overlap.
    const ROTATION: u32 = 7;

    /// Adds a word.
    #[inline]
    pub const fn add_word(&mut self, word: u32) {
        self.0 = self.0.rotate_left(Self::ROTATION) ^ word;
    }

    /// Returns non-zero if another sum differs.
    #[inline]
    #[must_use]
    pub const fn difference(self, other: Self) -> u32 {
        self.0 ^ other.0
    }

    /// Returns the sum itself, or a wrong one if its words are known to be corrupted.
    #[inline]
    #[must_use]
    pub fn marked(self, is_corrupted: bool) -> Self {
        Self(self.0 ^ u32::from(is_corrupted))
    }
}

/// Does some work while words wait in memory. Returns the words, non-zero if a bit of them has
/// flipped, and the result of the work. The words are read again from memory, so the compiler
/// cannot use copies in registers.
#[inline]
pub fn guard<const N: usize, R>(words: [u32; N], work: impl FnOnce() -> R) -> ([u32; N], u32, R) {
    let (mut words, mut sum) = (words, WordSum::from_words(&words));
    read_anew(&mut words);
    read_anew(&mut sum);
    let result = work();
    read_anew(&mut words);
    (words, WordSum::from_words(&words).difference(sum), result)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_flipped_bit_of_five_words_changes_the_sum() {
        let words = [450_000, 0xffff_ffff, 0, 3_000_000, 1 << 31];
        for place in 0..words.len() {
            for bit in 0..32 {
                let mut flipped = words;
                flipped[place] ^= 1 << bit;
                assert_ne!(
                    WordSum::from_words(&flipped),
                    WordSum::from_words(&words),
                    "word {place}, bit {bit}"
                );
            }
        }
    }

    #[test]
    fn guarded_words_and_the_result_are_returned() {
        let mut worked = 0;
        let work = || {
            worked += 1;
            "done"
        };
        assert_eq!(guard([7, 8, 9], work), ([7, 8, 9], 0, "done"));
        assert_eq!(worked, 1);
    }

    #[test]
    fn a_sum_that_is_marked_as_corrupted_differs() {
        let mut sum = WordSum::from_words(&[5]);
        sum.add_word(7);
        assert_ne!(sum.marked(true), sum);
        assert_eq!(sum.marked(false), sum);
    }
}
