//! Integer arithmetic of the tick: every operation saturates or wraps, none branches on data.

use crate::integrity::words;

/// Saturates to 32 bits.
#[inline]
pub(super) const fn saturated(value: i64) -> i32 {
    let (low, high) = (value as i32, (value >> 32) as i32);
    if high == low >> 31 { low } else { (high >> 31) ^ i32::MAX }
}

/// Saturates to 32 bits without a sign.
#[inline]
pub(super) const fn saturated_unsigned(value: u64) -> u32 {
    if value >> 32 == 0 { value as u32 } else { u32::MAX }
}

/// Limits a number to `-2^bits..2^bits`: one instruction.
#[inline]
pub(super) fn within(value: i32, bits: u32) -> i32 {
    let limit = 1_i32 << (bits & 31);
    value.max(limit.wrapping_neg()).min(limit.wrapping_sub(1))
}

/// Returns `a b / 2^shift`, rounded down. The product of two numbers of 32 bits has 63 bits: no
/// overflow.
#[inline]
pub(super) fn product(a: i32, b: i32, shift: u32) -> i64 {
    i64::from(a).wrapping_mul(i64::from(b)) >> (shift & 63)
}

/// Returns one of two numbers.
#[inline]
pub(super) fn select(condition: bool, yes: i32, no: i32) -> i32 {
    blend(i32::from(condition).wrapping_neg(), yes, no)
}

/// Returns the bits of one number where the mask has ones, those of the other where it has zeros.
#[inline]
pub(super) const fn blend(mask: i32, ones: i32, zeros: i32) -> i32 {
    (ones & mask) | (zeros & !mask)
}

/// [`select`] for 64 bits.
#[inline]
pub(super) fn select_wide(condition: bool, yes: i64, no: i64) -> i64 {
    let mask = i64::from(condition).wrapping_neg();
    (yes & mask) | (no & !mask)
}

/// Constant factor `multiplier / 2^shift`, prepared once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Factor {
    multiplier: i32,
    /// At most 31.
    shift: u32,
}
words!(Factor { multiplier, shift });

impl Factor {
    /// Returns the factor `numerator / denominator`, with an error of 2^-28 of itself or 2^-31,
    /// whichever is larger; 0 for a numerator of 0. The quotient must be below 2^29.
    pub(super) const fn new(numerator: u64, denominator: u64) -> Self {
        if numerator == 0 || denominator == 0 {
            return Self { multiplier: 0, shift: 0 };
        }
        // Numerator in 2^62 to 2^63, denominator in 2^31 to 2^32: the quotient has 31 to 33 bits.
        let up = numerator.leading_zeros() as i32 - 1;
        let numerator = if up < 0 { numerator >> 1 } else { numerator.wrapping_shl(up as u32) };
        let down = 32 - denominator.leading_zeros() as i32;
        let denominator = if down > 0 {
            denominator.wrapping_shr(down as u32)
        } else {
            denominator.wrapping_shl(down.unsigned_abs())
        };
        let quotient = numerator / if denominator == 0 { 1 } else { denominator };
        let excess = 34_i32.wrapping_sub(quotient.leading_zeros() as i32);
        let multiplier = quotient.wrapping_shr(excess as u32) as i32;
        let shift = up.wrapping_add(down).wrapping_sub(excess);
        // A small factor loses bits so that the shift stays below 32.
        let small = if shift > 31 { shift.wrapping_sub(31) as u32 } else { 0 };
        let multiplier = if small > 30 { 0 } else { multiplier.wrapping_shr(small) };
        Self { multiplier, shift: (shift as u32).wrapping_sub(small) & 31 }
    }

    /// Multiplies a number by the factor, rounded down and saturated.
    #[inline]
    pub(super) fn times(self, value: i32) -> i32 {
        // A shift of 64 bits by less than 32.
        let product = product(value, self.multiplier, 0);
        let (low, high) = (product as u32, (product >> 32) as i32);
        let carried = (high.cast_unsigned() << 1) << (31_u32.wrapping_sub(self.shift) & 31);
        let low = ((low >> (self.shift & 31)) | carried).cast_signed();
        let high = high >> (self.shift & 31);
        if high == low >> 31 { low } else { (high >> 31) ^ i32::MAX }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn factors_multiply(
            numerator in 1..u64::MAX, denominator in 1..u64::MAX,
            down in 0..60_u32, up in 0..60_u32, value in any::<i32>(),
        ) {
            let (numerator, denominator) = ((numerator >> down).max(1), (denominator >> up).max(1));
            let exact = numerator as f64 / denominator as f64;
            prop_assume!((1e-10..5e8).contains(&exact));
            let found = Factor::new(numerator, denominator).times(value);
            let expected = (f64::from(value) * exact).clamp(f64::from(i32::MIN), f64::from(i32::MAX));
            let off = 1.0 + 1e-8 * expected.abs() + f64::from(value).abs() / f64::from(1_u32 << 31);
            prop_assert!((f64::from(found) - expected).abs() <= off, "{} {}", found, expected);
        }

        #[test]
        fn limits_hold(
            value in any::<i64>(), down in 0..63_u32, bits in 0..31_u32,
            a in any::<i32>(), b in any::<i32>(), condition: bool,
        ) {
            prop_assert_eq!(i64::from(saturated(value)), value.clamp(i32::MIN.into(), i32::MAX.into()));
            let wide = value >> down;
            prop_assert_eq!(i64::from(saturated(wide)), wide.clamp(i32::MIN.into(), i32::MAX.into()));
            let wide = value.unsigned_abs() >> down;
            prop_assert_eq!(u64::from(saturated_unsigned(wide)), wide.min(u32::MAX.into()));
            prop_assert_eq!(i64::from(within(a, bits)), i64::from(a).clamp(-(1 << bits), (1 << bits) - 1));
            prop_assert_eq!(select(condition, a, b), if condition { a } else { b });
            let selected = if condition { value } else { a.into() };
            prop_assert_eq!(select_wide(condition, value, a.into()), selected);
            prop_assert_eq!(product(a, b, 30), (i64::from(a) * i64::from(b)) >> 30);
        }
    }
}
