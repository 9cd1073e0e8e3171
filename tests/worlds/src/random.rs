//! Seeded random numbers: SplitMix64 (Steele, Lea, Flood 2014) and the Box-Muller transform.

use std::f64::consts::TAU;

/// Stream of random numbers.
#[derive(Clone, Debug)]
pub struct Random(u64);

/// Returns the seed of a purpose. Seeds of different purposes are independent.
pub fn subseed(seed: u64, purpose: &str) -> u64 {
    // FNV-1a over the name.
    let name = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3);
    mix(mix(seed) ^ purpose.bytes().fold(0xCBF2_9CE4_8422_2325, name))
}

const fn mix(bits: u64) -> u64 {
    let bits = bits.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mixed = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    mixed ^ (mixed >> 31)
}

impl Random {
    /// Creates the stream of a seed and a purpose.
    pub fn new(seed: u64, purpose: &str) -> Self {
        Self(subseed(seed, purpose))
    }

    /// Returns a uniform number in [0, 1).
    pub const fn uniform(&mut self) -> f64 {
        let bits = mix(self.0);
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        (bits >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Returns a normal number with mean 0 and variance 1.
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (TAU * self.uniform()).cos()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stream_of_seed_1234567_is_that_of_the_reference_implementation() {
        let mut random = Random(1_234_567);
        let numbers: Vec<f64> = (0..3).map(|_| random.uniform()).collect();
        let bits = [6_457_827_717_110_365_317_u64, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423];
        assert_eq!(numbers, bits.map(|bits| (bits >> 11) as f64 / (1_u64 << 53) as f64));
    }

    #[test]
    fn normal_numbers_have_the_moments_of_the_distribution() {
        let mut random = Random::new(1, "test");
        let numbers: Vec<f64> = (0..100_000).map(|_| random.normal()).collect();
        let moment = |power: i32| numbers.iter().map(|x| x.powi(power)).sum::<f64>() / numbers.len() as f64;
        let (mean, variance, fourth) = (moment(1), moment(2), moment(4));
        assert!(mean.abs() < 0.02 && (variance - 1.0).abs() < 0.02 && (fourth - 3.0).abs() < 0.15);
        assert_ne!(subseed(1, "test"), subseed(1, "other"));
        assert_ne!(subseed(1, "test"), subseed(2, "test"));
    }
}
