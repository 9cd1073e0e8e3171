//! Arithmetic in whole numbers that the tick is made of: every operation saturates or wraps, none branches on data.

/// The nearest number of 32 bits.
#[inline]
pub(super) fn saturated(value: i64) -> i32 {
    value.max(i64::from(i32::MIN)).min(i64::from(i32::MAX)) as i32
}

/// A number within `-limit..=limit`.
#[inline]
pub(super) fn within(value: i64, limit: i32) -> i32 {
    value.max(-i64::from(limit)).min(i64::from(limit)) as i32
}

/// `a b / 2^shift`, rounded down. No overflow: the product of two numbers of 32 bits has 63.
#[inline]
pub(super) fn product(a: i32, b: i32, shift: u32) -> i64 {
    i64::from(a).wrapping_mul(i64::from(b)) >> (shift & 63)
}

/// One of two numbers.
#[inline]
pub(super) fn select(condition: bool, yes: i32, no: i32) -> i32 {
    let mask = i32::from(condition).wrapping_neg();
    (yes & mask) | (no & !mask)
}

/// [`select`] for wide numbers.
#[inline]
pub(super) fn select_wide(condition: bool, yes: i64, no: i64) -> i64 {
    let mask = i64::from(condition).wrapping_neg();
    (yes & mask) | (no & !mask)
}

/// A constant factor, prepared once: 30 significant bits and a power of two.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Factor {
    multiplier: i32,
    shift: u32,
}

impl Factor {
    /// `numerator / denominator`, to 2^-28 of itself; 0 for a numerator of 0. The quotient must lie between 2^-33 and 2^29.
    pub(super) const fn of(numerator: u64, denominator: u64) -> Self {
        if numerator == 0 || denominator == 0 {
            return Self { multiplier: 0, shift: 0 };
        }
        // The numerator at 2^62 to 2^63, the denominator at 2^31 to 2^32: their quotient has 31 to 33 bits.
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
        let shift = up.wrapping_add(down).wrapping_sub(excess) as u32;
        Self { multiplier: quotient.wrapping_shr(excess as u32) as i32, shift: shift & 63 }
    }

    /// The number times the factor, rounded down and saturated.
    #[inline]
    pub(super) fn times(self, value: i32) -> i32 {
        saturated(product(value, self.multiplier, self.shift))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn factors_multiply(numerator in 1..u64::MAX, denominator in 1..u64::MAX, down in 0..60_u32, up in 0..60_u32, value in any::<i32>()) {
            let (numerator, denominator) = ((numerator >> down).max(1), (denominator >> up).max(1));
            let exact = numerator as f64 / denominator as f64;
            prop_assume!((1e-10..5e8).contains(&exact));
            let found = Factor::of(numerator, denominator).times(value);
            let expected = (f64::from(value) * exact).clamp(f64::from(i32::MIN), f64::from(i32::MAX));
            prop_assert!((f64::from(found) - expected).abs() <= 1.0 + 1e-8 * expected.abs(), "{} {}", found, expected);
        }

        #[test]
        fn limits_hold(value in any::<i64>(), limit in 0..i32::MAX, a in any::<i32>(), b in any::<i32>(), condition: bool) {
            prop_assert_eq!(i64::from(saturated(value)), value.clamp(i32::MIN.into(), i32::MAX.into()));
            prop_assert_eq!(i64::from(within(value, limit)), value.clamp((-limit).into(), limit.into()));
            prop_assert_eq!(select(condition, a, b), if condition { a } else { b });
            prop_assert_eq!(select_wide(condition, value, a.into()), if condition { value } else { a.into() });
            prop_assert_eq!(product(a, b, 30), (i64::from(a) * i64::from(b)) >> 30);
        }
    }
}
