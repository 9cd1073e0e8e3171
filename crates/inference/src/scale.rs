//! Scale of a head's sums.

/// Value of one count of a head's sum: `multiplier / 2^shift`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Scale {
    /// Multiplier above 0, with full precision from 2^30 on.
    pub multiplier: i32,
    /// Power of two to divide by: 25 to 78.
    pub shift: u32,
}

impl Scale {
    /// Returns a sum in the scale's unit, times 2^`fraction_bits` (15 to 25), rounded down; 0 for a
    /// negative sum, at most `u32::MAX`.
    #[inline]
    pub fn apply(self, sum: i32, fraction_bits: u32) -> u32 {
        let product = (sum.max(0) as u32 as u64).wrapping_mul(self.multiplier as u32 as u64);
        // The loader has checked that the shift stays within 0..=63.
        let value = product >> (self.shift.wrapping_sub(fraction_bits) & 63);
        value.min(u64::from(u32::MAX)) as u32
    }

    /// Returns the scale as a floating-point number, for reports.
    pub fn to_f64(self) -> f64 {
        f64::from(self.multiplier) / libm::exp2(f64::from(self.shift))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scale_multiplies_rounds_down_and_saturates() {
        let scale = Scale { multiplier: 3 << 29, shift: 45 };
        assert!((scale.to_f64() - 1.5 / 32768.0).abs() < 1e-18);
        assert_eq!(scale.apply(32768, 16), 3 << 15);
        assert_eq!(scale.apply(-5, 16), 0);
        assert_eq!(Scale { multiplier: i32::MAX, shift: 25 }.apply(i32::MAX, 24), u32::MAX);
    }
}
