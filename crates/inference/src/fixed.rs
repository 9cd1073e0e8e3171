//! Fractions and roots in whole numbers: the arithmetic of the features.
//!
//! Every function takes the same instructions for all of its arguments (the core's divider takes 2 to 12 cycles on its
//! own), and none divides more than 32 bits.

/// `numerator / denominator` times 2^32; `u32::MAX` from 1 on and for a denominator of 0. At most 12 counts too low (9 in
/// 4e8 random pairs), never too high.
#[inline]
pub fn fraction(numerator: u32, denominator: u32) -> u32 {
    let shift = denominator.leading_zeros() & 31;
    let (scaled, divisor) = (numerator << shift, denominator << shift);
    // Above the high half of the divisor: no digit comes out too large.
    let half = (divisor >> 16).wrapping_add(1);
    let first = scaled / half;
    let rest = (u64::from(scaled) << 16).wrapping_sub(u64::from(first).wrapping_mul(u64::from(divisor)));
    let second = ((rest >> 2) as u32 / half) << 2;
    let quotient = (first << 16).wrapping_add(second);
    if numerator < denominator { quotient } else { u32::MAX }
}

/// [`fraction`] of two numbers of 64 bits, both rounded down to 32 significant bits of the denominator. The numerator must not
/// be above the denominator: it would be cut off.
#[inline]
pub fn fraction_wide(numerator: u64, denominator: u64) -> u32 {
    let shift = 32u32.saturating_sub(denominator.leading_zeros());
    fraction((numerator >> shift) as u32, (denominator >> shift) as u32)
}

/// Division by a constant: multiplication with its reciprocal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Reciprocal {
    multiplier: u32,
    shift: u32,
}

impl Reciprocal {
    /// Prepares the division by a number above 0.
    pub fn of(denominator: u32) -> Self {
        let shift = 31u32.saturating_sub(denominator.leading_zeros());
        let multiplier = (1u64 << 32).wrapping_shl(shift) / u64::from(denominator.max(1));
        // A power of two needs one bit more than there is: one count less does.
        Self { multiplier: u32::try_from(multiplier).unwrap_or(u32::MAX), shift }
    }

    /// `numerator / denominator` times 2^`fraction_bits` (0 to 32), saturated.
    #[inline]
    pub fn fraction(self, numerator: u32, fraction_bits: u32) -> u32 {
        let product = u64::from(numerator).wrapping_mul(u64::from(self.multiplier));
        let value = product >> (self.shift.wrapping_add(32).wrapping_sub(fraction_bits) & 63);
        value.min(u64::from(u32::MAX)) as u32
    }
}

/// Twice the square root: that of a fraction of 2^32 as one of 2^17, to a count.
///
/// Two steps of Newton's from a line. The standard library's root takes a different way for small numbers.
#[inline]
pub fn root(fraction: u32) -> u32 {
    // By an even shift to 2^30..2^32, where 0.686 x + 22102 is within 3 % of the root of 2^16 x.
    let shift = (fraction | 1).leading_zeros() & !1;
    let scaled = fraction << shift;
    let line = ((scaled >> 16).wrapping_mul(44_958) >> 16).wrapping_add(22_102);
    let first = line.wrapping_add(scaled / line) >> 1;
    first.wrapping_add(scaled / first) >> (shift / 2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn fractions_are_right_to_a_few_counts(a in any::<u32>(), b in any::<u32>(), shift in 0u32..31) {
            let (numerator, denominator) = ((a.min(b)) >> shift, (a.max(b)) >> shift);
            let exact = if numerator < denominator {
                (u64::from(numerator) << 32) / u64::from(denominator)
            } else {
                u64::from(u32::MAX)
            };
            let found = u64::from(fraction(numerator, denominator));
            prop_assert!(found <= exact && exact - found <= 12, "{} {}", found, exact);
        }

        #[test]
        fn wide_fractions_are_right_to_a_few_counts(a in any::<u64>(), b in any::<u64>(), shift in 0u32..63) {
            let (numerator, denominator) = ((a.min(b)) >> shift, (a.max(b)) >> shift);
            let exact = if numerator < denominator {
                ((u128::from(numerator)) << 32) / u128::from(denominator)
            } else {
                u128::from(u32::MAX)
            };
            let found = u128::from(fraction_wide(numerator, denominator));
            prop_assert!(found.abs_diff(exact) <= 16, "{} {}", found, exact);
        }

        #[test]
        fn reciprocals_divide(numerator in any::<u32>(), denominator in 1..u32::MAX) {
            let numerator = numerator.min(denominator);
            let exact = ((u64::from(numerator) << 30) / u64::from(denominator)) as u32;
            prop_assert!(Reciprocal::of(denominator).fraction(numerator, 30).abs_diff(exact) <= 1);
        }

        #[test]
        fn roots_are_right_to_a_count(fraction in any::<u32>()) {
            let exact = 2.0 * f64::from(fraction).sqrt();
            let found = f64::from(root(fraction));
            prop_assert!((found - exact).abs() <= 1.0 || fraction == 0 && found == 0.0, "{} {}", found, exact);
        }
    }
}
