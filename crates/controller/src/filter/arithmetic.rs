//! Roots, extremes and the sine in f32: the same bits on every machine, without division or call.

use core::f32::consts::FRAC_PI_2;

/// Returns 1 over the root of a number above 0, with a relative error below 3e-7.
///
/// The first guess is the known bit pattern of Walsh; three steps of Newton's method follow. Of 0
/// it is a large finite number, so that `x * inverse_root(x)` is 0.
pub(super) fn inverse_root(x: f32) -> f32 {
    let mut root = f32::from_bits(0x5f37_59df_u32.wrapping_sub(x.to_bits() >> 1));
    let half = 0.5 * x;
    for _ in 0..3 {
        root *= 1.5 - half * root * root;
    }
    root
}

/// Returns the root of a number of 0 or more.
pub(super) fn root(x: f32) -> f32 {
    x * inverse_root(x)
}

/// Returns the larger of two numbers, and the second if the first is not a number.
///
/// `f32::max` is a call of a library on a Cortex-M4.
pub(super) fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// Returns the smaller of two numbers, and the second if the first is not a number.
pub(super) fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// Returns the sine of an angle in rad. Up to a quarter turn it is Taylor's series, with an error
/// below 2e-7; a crank does not turn further.
pub(super) fn sine(angle: f32) -> f32 {
    if angle.abs() > FRAC_PI_2 {
        return libm::sinf(angle);
    }
    let square = angle * angle;
    let series = 2.755_731_9e-6 + square * (-2.505_210_8e-8 + square * 1.605_904_4e-10);
    let series = -1.984_127e-4 + square * series;
    angle * (1.0 + square * (-1.666_666_7e-1 + square * (8.333_334e-3 + square * series)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_root_of_nothing_is_0_and_that_of_no_number_is_none() {
        assert_eq!(root(0.0), 0.0);
        assert!(root(f32::NAN).is_nan());
    }

    proptest! {
        #[test]
        fn roots_agree_with_the_exact_ones(exponent in -30.0..30.0_f32) {
            let x = 10_f32.powf(exponent);
            prop_assert!((root(x) / x.sqrt() - 1.0).abs() < 3e-7);
            prop_assert!((inverse_root(x) * x.sqrt() - 1.0).abs() < 3e-7);
        }

        #[test]
        fn sines_agree_with_the_exact_ones(angle in -7.0..7.0_f32) {
            prop_assert!((f64::from(sine(angle)) - f64::from(angle).sin()).abs() < 2e-7);
        }
    }
}
