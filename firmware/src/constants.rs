//! What is set with a configuration and must stay as long as its run: summed up once, and again and again.
//!
//! Who keeps such constants beside its state gives them, field by field, to a [`Sum`] (`constants`). The session holds the sum against that of
//! the run's begin ([`crate::Session::constants_hold`]); on the board that is done in every pass of the link's loop. The sum is that of
//! [`crate::supervisor::code`]: whatever changes within one word is noticed for certain.
//!
//! Not covered is state: what changes with every sample has a sum of its own ([`inference::held`]), is kept twice (the networks'
//! history), has to be plausible, or to be gone after a window.

use core::hash::Hasher;

use crate::supervisor::code::{START, add};

/// Sums words up.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sum(u32);

impl Sum {
    pub(crate) const fn new() -> Self {
        Self(START)
    }

    /// A floating-point number, bit by bit.
    pub(crate) const fn float(&mut self, value: f32) {
        self.0 = add(self.0, value.to_bits());
    }

    pub(crate) fn floats(&mut self, values: &[f32]) {
        for value in values {
            self.float(*value);
        }
    }

    pub(crate) const fn sum(self) -> u32 {
        self.0
    }
}

impl Hasher for Sum {
    fn finish(&self) -> u64 {
        self.0.into()
    }

    fn write(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = add(self.0, u32::from(*byte));
        }
    }

    fn write_u32(&mut self, word: u32) {
        self.0 = add(self.0, word);
    }

    fn write_u64(&mut self, word: u64) {
        self.write_u32(word as u32);
        self.write_u32((word >> 32) as u32);
    }

    fn write_usize(&mut self, word: usize) {
        self.write_u64(word as u64);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::hash::Hash;

    fn sum(words: [i32; 2], wide: u64, float: f32) -> u32 {
        let mut sum = Sum::new();
        words.hash(&mut sum);
        wide.hash(&mut sum);
        sum.float(float);
        sum.sum()
    }

    #[test]
    fn every_bit_counts() {
        let base = sum([1, 2], 3, 4.0);
        for bit in 0..32 {
            assert_ne!(sum([1 ^ 1 << bit, 2], 3, 4.0), base);
            assert_ne!(sum([1, 2 ^ 1 << bit], 3, 4.0), base);
            assert_ne!(sum([1, 2], 3 ^ 1 << (2 * bit), 4.0), base);
            assert_ne!(sum([1, 2], 3, f32::from_bits(4.0_f32.to_bits() ^ 1 << bit)), base);
        }
    }
}
