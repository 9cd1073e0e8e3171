//! Numbers that wait in memory while something else works, with a sum that tells whether they are still what was put there.
//!
//! A tick keeps its intermediate results on the stack for as long as the networks take. A bit that flips there would spoil the forces by too little
//! for any limit.

pub use crate::kernel::read_anew;

/// Odd, so that the bits of neighbouring words do not lie on each other.
const TURN: u32 = 7;

/// A sum over words: each is added to the sum turned by some bits, exclusive or. Any one bit that flips, in a word or in the sum kept beside them,
/// shows for certain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WordSum(u32);

impl WordSum {
    /// The sum of some words.
    #[inline]
    #[must_use]
    pub fn of(words: &[u32]) -> Self {
        let mut sum = Self::default();
        words.iter().for_each(|&word| sum.word(word));
        sum
    }

    /// Adds a word.
    #[inline]
    pub const fn word(&mut self, word: u32) {
        self.0 = self.0.rotate_left(TURN) ^ word;
    }

    /// Adds a number of two words.
    #[inline]
    pub const fn wide(&mut self, number: i64) {
        let number = number.cast_unsigned();
        self.word(number as u32);
        self.word((number >> 32) as u32);
    }

    /// Not 0 where another sum is not this one.
    #[inline]
    #[must_use]
    pub const fn difference(self, other: Self) -> u32 {
        self.0 ^ other.0
    }

    /// The sum itself, or another one, so that what it was made of is not taken for sound.
    #[inline]
    #[must_use]
    pub fn spoilt(self, spoilt: bool) -> Self {
        Self(self.0 ^ u32::from(spoilt))
    }
}

/// Does some work while words wait for it in memory; gives the words, not 0 where a bit of them is no longer what it was, and what the work gave.
///
/// The compiler cannot go on with copies of its own: the words are read anew.
#[inline]
pub fn hold<const N: usize, R>(words: [u32; N], work: impl FnOnce() -> R) -> ([u32; N], u32, R) {
    let (mut words, mut sum) = (words, WordSum::of(&words));
    read_anew(&mut words);
    read_anew(&mut sum);
    let result = work();
    read_anew(&mut words);
    (words, WordSum::of(&words).difference(sum), result)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bit_of_five_words_counts() {
        let words = [450_000, 0xffff_ffff, 0, 3_000_000, 1 << 31];
        for place in 0..words.len() {
            for bit in 0..32 {
                let mut flipped = words;
                flipped[place] ^= 1 << bit;
                assert_ne!(WordSum::of(&flipped), WordSum::of(&words), "word {place}, bit {bit}");
            }
        }
    }

    #[test]
    fn what_is_held_comes_back() {
        let mut worked = 0;
        let work = || {
            worked += 1;
            "done"
        };
        assert_eq!(hold([7, 8, 9], work), ([7, 8, 9], 0, "done"));
        assert_eq!(worked, 1);
    }

    #[test]
    fn the_sum_of_what_is_spoilt_is_another_one() {
        let mut sum = WordSum::of(&[5]);
        sum.wide(-7);
        assert_ne!(sum.spoilt(true), sum);
        assert_eq!(sum.spoilt(false), sum);
    }
}
