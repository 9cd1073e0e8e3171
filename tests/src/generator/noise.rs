//! Random numbers of the log generator: SplitMix64 and the polar method (the engine has ChaCha and
//! the ziggurat).

use crate::random::SplitMix64;

/// Seeded stream of uniform and normal numbers.
pub struct Noise {
    random: SplitMix64,
    spare: Option<f64>,
}

impl Noise {
    /// Returns the stream of a seed.
    pub fn new(seed: u64) -> Self {
        let random = SplitMix64(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x1234_5678);
        Self { random, spare: None }
    }

    /// Returns a uniform number in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        self.random.unit()
    }

    /// Returns a normal number with unit variance.
    pub fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        loop {
            let (a, b) = (2.0 * self.uniform() - 1.0, 2.0 * self.uniform() - 1.0);
            let square = a * a + b * b;
            if square > 0.0 && square < 1.0 {
                let factor = (-2.0 * square.ln() / square).sqrt();
                self.spare = Some(b * factor);
                return a * factor;
            }
        }
    }
}
