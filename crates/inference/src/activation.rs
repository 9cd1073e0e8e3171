//! Widths of an activation: 16 bits (default and reference) or 8 bits (compact).
//!
//! Activations have no zero point: zero padding is 0, and no kernel subtracts an offset. After a
//! ReLU they are 0 to [`Activation::MAX`]. Features also use the negative half.

mod sealed {
    pub trait Sealed {}
    impl Sealed for i8 {}
    impl Sealed for i16 {}
}

/// An activation: `i16` or `i8`.
pub trait Activation: sealed::Sealed + bytemuck::Pod + Default + Ord + core::fmt::Debug {
    /// Width in bits.
    const BITS: u8;
    /// Largest value: full scale.
    const MAX: i32;

    /// Returns the value with 32 bits.
    fn widen(self) -> i32;

    /// Returns the lowest bits of a value.
    fn from_i32(value: i32) -> Self;

    /// Applies ReLU and saturation: clips to 0..=[`Self::MAX`].
    fn clip(value: i32) -> Self;
}

impl Activation for i16 {
    const BITS: u8 = 16;
    const MAX: i32 = i16::MAX as i32;

    #[inline]
    fn widen(self) -> i32 {
        i32::from(self)
    }

    #[inline]
    fn from_i32(value: i32) -> Self {
        value as Self
    }

    #[inline]
    fn clip(value: i32) -> Self {
        value.clamp(0, <Self as Activation>::MAX) as Self
    }
}

impl Activation for i8 {
    const BITS: u8 = 8;
    const MAX: i32 = i8::MAX as i32;

    #[inline]
    fn widen(self) -> i32 {
        i32::from(self)
    }

    #[inline]
    fn from_i32(value: i32) -> Self {
        value as Self
    }

    #[inline]
    fn clip(value: i32) -> Self {
        value.clamp(0, <Self as Activation>::MAX) as Self
    }
}
