//! Fractions and square roots in fixed point: the arithmetic of the features.
//!
//! Every function executes the same instructions for all arguments (the divider of the core itself
//! takes 2 to 12 cycles). No division is wider than 32 bits.

/// Returns `numerator / denominator` times 2^32; `u32::MAX` from 1 on and for a denominator of 0.
/// The result is never too high and at most 12 counts too low (9 in 4e8 random pairs).
#[inline]
pub(crate) fn fraction(numerator: u32, denominator: u32) -> u32 {
    let shift = denominator.leading_zeros() & 31;
    let (scaled, divisor) = (numerator << shift, denominator << shift);
    // Larger than the high half of the divisor, so no digit becomes too large.
    let half = (divisor >> 16).wrapping_add(1);
    let first = scaled / half;
    let remainder = (u64::from(scaled) << 16).wrapping_sub(u64::from(first).wrapping_mul(u64::from(divisor)));
    let second = ((remainder >> 2) as u32 / half) << 2;
    let quotient = (first << 16).wrapping_add(second);
    if numerator < denominator { quotient } else { u32::MAX }
}

/// Returns [`fraction`] of two 64-bit numbers, both rounded down to 32 significant bits of the
/// denominator. The numerator must not exceed the denominator, or it is truncated.
#[inline]
pub(crate) fn fraction_wide(numerator: u64, denominator: u64) -> u32 {
    let shift = 32u32.saturating_sub(denominator.leading_zeros());
    fraction((numerator >> shift) as u32, (denominator >> shift) as u32)
}

/// Division by a constant as a multiplication with its reciprocal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Reciprocal {
    multiplier: u32,
    shift: u32,
}

impl Reciprocal {
    /// Prepares the division by a number above 0.
    pub(crate) fn new(denominator: u32) -> Self {
        let shift = 31u32.saturating_sub(denominator.leading_zeros());
        let multiplier = (1u64 << 32).wrapping_shl(shift) / u64::from(denominator.max(1));
        // The reciprocal of a power of two needs 33 bits; one count less is used.
        Self { multiplier: u32::try_from(multiplier).unwrap_or(u32::MAX), shift }
    }

    /// Returns `numerator / denominator` times 2^`fraction_bits` (0 to 32), saturated.
    #[inline]
    pub(crate) fn fraction(self, numerator: u32, fraction_bits: u32) -> u32 {
        let product = u64::from(numerator).wrapping_mul(u64::from(self.multiplier));
        let value = product >> (self.shift.wrapping_add(32).wrapping_sub(fraction_bits) & 63);
        value.min(u64::from(u32::MAX)) as u32
    }
}

/// Returns twice the square root of a fraction: times 2^32 in, times 2^17 out, exact to one count.
///
/// Two Newton steps from a linear start value. The square root of the standard library branches on
/// small numbers.
#[inline]
pub(crate) fn root(fraction: u32) -> u32 {
    // Normalised by an even shift to 2^30..2^32, where 0.686 x + 22102 is within 3 % of the root of
    // 2^16 x.
    let shift = (fraction | 1).leading_zeros() & !1;
    let scaled = fraction << shift;
    let line = ((scaled >> 16).wrapping_mul(44_958) >> 16).wrapping_add(22_102);
    let first = line.wrapping_add(scaled / line) >> 1;
    first.wrapping_add(scaled / first) >> (shift / 2)
}

/// Multiplies a root force by a factor times 2^30, saturated.
#[inline]
pub fn scaled_root(root: u32, factor_q30: u32) -> u32 {
    (u64::from(root).wrapping_mul(u64::from(factor_q30)) >> 30).min(u64::from(u32::MAX)) as u32
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
            prop_assert!(Reciprocal::new(denominator).fraction(numerator, 30).abs_diff(exact) <= 1);
        }

        #[test]
        fn roots_are_right_to_a_count(fraction in any::<u32>()) {
            let exact = 2.0 * f64::from(fraction).sqrt();
            let found = f64::from(root(fraction));
            let is_exact = (found - exact).abs() <= 1.0 || fraction == 0 && found == 0.0;
            prop_assert!(is_exact, "{} {}", found, exact);
        }
    }
}
