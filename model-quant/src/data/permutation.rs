//! A pseudo-random permutation of `0..count` with random access and constant memory.
//!
//! It is a balanced Feistel network of six rounds over the smallest even number of bits that holds
//! `count`, with cycle walking: an image outside `0..count` is mapped again until it lies inside,
//! which gives a permutation of `0..count` (Black and Rogaway, "Ciphers with arbitrary finite
//! domains", 2002). This takes at most 4 passes on average, 1.12 for 1.5e7.

use crate::data::draw::{Draw, Purpose};

/// Rounds of the network.
const ROUNDS: usize = 6;

/// A seeded permutation of `0..count`.
#[derive(Clone, Debug)]
pub(crate) struct Permutation {
    count: u64,
    half_bits: u32,
    keys: [u64; ROUNDS],
}

impl Permutation {
    /// Creates the permutation for a seed; `count` up to 2^62.
    pub(crate) fn new(count: u64, seed: u64) -> Self {
        let bits = u64::BITS - count.saturating_sub(1).leading_zeros();
        let mut draw = Draw::new(seed, Purpose::DatasetOrder, 0);
        let keys = core::array::from_fn(|_| (draw.unit() * 9_007_199_254_740_992.0) as u64);
        Self { count, half_bits: bits.div_ceil(2).max(1), keys }
    }

    /// Image of an index; indices of `count` and above are taken modulo `count`.
    pub(crate) fn at(&self, index: u64) -> u64 {
        if self.count == 0 {
            return 0;
        }
        let mut image = self.pass(index % self.count);
        while image >= self.count {
            image = self.pass(image);
        }
        image
    }

    fn pass(&self, value: u64) -> u64 {
        let mask = (1 << self.half_bits) - 1;
        let (mut left, mut right) = (value >> self.half_bits, value & mask);
        for key in self.keys {
            (left, right) = (right, left ^ (mix(right ^ key) & mask));
        }
        left << self.half_bits | right
    }
}

/// The finaliser of SplitMix64.
fn mix(value: u64) -> u64 {
    let value = (value ^ value >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let value = (value ^ value >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    value ^ value >> 31
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_index_has_one_image_and_every_image_one_index() {
        for count in [1, 2, 3, 15, 16, 17, 1000, 65_537, 15_000_000] {
            let permutation = Permutation::new(count, 5);
            let mut seen = vec![false; count as usize];
            for index in 0..count {
                let image = permutation.at(index) as usize;
                assert!(!seen[image], "{image} twice among {count}");
                seen[image] = true;
            }
        }
        assert_eq!(Permutation::new(0, 5).at(3), 0);
    }

    #[test]
    fn neighbours_are_uncorrelated_and_seeds_differ() {
        let count = 1_000_000;
        let (one, other) = (Permutation::new(count, 1), Permutation::new(count, 2));
        let images: Vec<f64> = (0..20_000).map(|i| one.at(i) as f64 / count as f64).collect();
        // A uniform distribution has the mean 1/2 (standard error .002); neighbours have the
        // correlation 0 (standard error .007).
        let mean = images.iter().sum::<f64>() / images.len() as f64;
        assert!((mean - 0.5).abs() < 0.01, "{mean}");
        let products = images.windows(2).map(|w| (w[0] - mean) * (w[1] - mean)).sum::<f64>();
        let correlation = products / images.len() as f64 * 12.0;
        assert!(correlation.abs() < 0.03, "{correlation}");
        let same = (0..20_000).filter(|&i| one.at(i) == other.at(i)).count();
        assert!(same < 5, "{same}");
    }
}
