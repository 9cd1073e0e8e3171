//! Number type of the laws: `f64` on the host, `f32` on a controller with single precision only.
//!
//! This sealed trait replaces `num-traits`. There the functions come from the standard library or
//! from `libm`, depending on the features of the build, and so would the bits of a force. Here
//! every function is `libm`'s, on every machine.

use core::fmt::Debug;
use core::ops::{Add, Div, Mul, Neg, Sub};

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

/// `f32` or `f64`.
pub trait Real:
    sealed::Sealed
    + Copy
    + Debug
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// Distance from 1 to the next larger number.
    const EPSILON: Self;
    /// Returns the nearest number to a constant.
    fn from_f64(value: f64) -> Self;
    /// Returns the same number in double precision.
    fn to_f64(self) -> f64;
    /// Square root.
    fn sqrt(self) -> Self;
    /// `e^self`.
    fn exp(self) -> Self;
    /// Natural logarithm.
    fn ln(self) -> Self;
    /// `self^exponent`.
    fn powf(self, exponent: Self) -> Self;
    /// Hyperbolic tangent.
    fn tanh(self) -> Self;
    /// Arc cosine.
    fn acos(self) -> Self;
    /// Magnitude.
    fn abs(self) -> Self;
    /// Larger of two numbers; the other one if one is not a number.
    fn max(self, other: Self) -> Self;
    /// Smaller of two numbers; the other one if one is not a number.
    fn min(self, other: Self) -> Self;
    /// Magnitude of `self` with the sign of another number.
    fn copysign(self, sign: Self) -> Self;
    /// Decides whether the number is neither infinite nor not-a-number.
    fn is_finite(self) -> bool;

    /// -1, 0 or 1; 0 at both zeros.
    fn sign(self) -> Self {
        if self == Self::ZERO { Self::ZERO } else { Self::ONE.copysign(self) }
    }
}

macro_rules! real {
    ($type:ident: $sqrt:ident $exp:ident $log:ident $pow:ident $tanh:ident $acos:ident $abs:ident
     $max:ident $min:ident $copysign:ident) => {
        impl Real for $type {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const EPSILON: Self = $type::EPSILON;
            fn from_f64(value: f64) -> Self {
                value as Self
            }
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            fn sqrt(self) -> Self {
                libm::$sqrt(self)
            }
            fn exp(self) -> Self {
                libm::$exp(self)
            }
            fn ln(self) -> Self {
                libm::$log(self)
            }
            fn powf(self, exponent: Self) -> Self {
                libm::$pow(self, exponent)
            }
            fn tanh(self) -> Self {
                libm::$tanh(self)
            }
            fn acos(self) -> Self {
                libm::$acos(self)
            }
            fn abs(self) -> Self {
                libm::$abs(self)
            }
            fn max(self, other: Self) -> Self {
                libm::$max(self, other)
            }
            fn min(self, other: Self) -> Self {
                libm::$min(self, other)
            }
            fn copysign(self, sign: Self) -> Self {
                libm::$copysign(self, sign)
            }
            fn is_finite(self) -> bool {
                $type::is_finite(self)
            }
        }
    };
}

real!(f32: sqrtf expf logf powf tanhf acosf fabsf fmaxf fminf copysignf);
real!(f64: sqrt exp log pow tanh acos fabs fmax fmin copysign);
