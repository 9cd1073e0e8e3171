//! A small generator: its seed is all that a failing case has to show.

/// Linear congruential, upper bits.
#[derive(Clone, Debug)]
pub struct Noise(pub u64);

impl Noise {
    /// The next 31 bits.
    pub fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 33) as u32
    }

    /// Uniform in `-magnitude..=magnitude`.
    pub fn within(&mut self, magnitude: u32) -> i32 {
        let width = 2 * magnitude + 1;
        (self.bits() % width).cast_signed() - magnitude.cast_signed()
    }
}
