//! Small random generator; its seed reproduces a failing case.

/// Linear congruential generator; returns the upper bits.
#[derive(Clone, Debug)]
pub struct Noise(pub u64);

impl Noise {
    /// Returns the next 31 bits.
    pub fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 33) as u32
    }

    /// Returns a number uniform in `-magnitude..=magnitude`.
    pub fn within(&mut self, magnitude: u32) -> i32 {
        let width = 2 * magnitude + 1;
        (self.bits() % width).cast_signed() - magnitude.cast_signed()
    }
}
