//! Storage formats of a layer's weights.
//!
//! The taps of an output (column by column, oldest first, inputs of a column in order) are split
//! into groups. The last group is padded with zero weights. A group is a word of four bytes, lowest
//! first. Outputs are stored in blocks of four: `[block of 4 outputs][word][output]`. The remaining
//! outputs (if not divisible by 4) follow row by row: `[output][word]`. The words of an output are
//! its groups of weights. In a convolution the bias precedes them and the multiplier follows them,
//! so that a kernel reads a layer from start to end.
//!
//! | form | weights | activations | a group | for |
//! |---|---|---|---|---|
//! | [`Wide`] | 16 bits | 16 bits | taps 0 1 | speed, and weights of more than 8 bits |
//! | [`Packed16`] | 8 bits | 16 bits | taps 0 2 1 3 | half the flash |
//! | [`Packed8`] | 8 bits | 8 bits | taps 0 1 2 3 | half the flash and half the RAM |
//!
//! The order inside a packed group suits the instruction SXTB16, which widens bytes 0 and 2 of a
//! word (and, rotated by 8, bytes 1 and 3). In memory 16-bit activations are pairs (0 1) (2 3);
//! 8-bit activations unpack to (0 2) (1 3).

use crate::activation::Activation;

mod sealed {
    pub trait Sealed {}
    impl Sealed for super::Wide {}
    impl Sealed for super::Packed16 {}
    impl Sealed for super::Packed8 {}
}

/// Storage form of weights.
pub trait Storage: sealed::Sealed + Copy + core::fmt::Debug + 'static {
    /// Activations that these weights are multiplied with.
    type Activation: Activation;
    /// Number of taps in a group.
    const TAPS: usize;

    /// Returns the weight of a tap of a group.
    fn weight(group: u32, tap: usize) -> i32;

    /// Writes a weight into a group. Weights that do not fit are truncated.
    fn put(group: &mut u32, tap: usize, weight: i16);
}

/// Number of groups for a number of taps.
pub const fn groups<S: Storage>(taps: usize) -> usize {
    taps.div_ceil(S::TAPS)
}

/// Number of words of a convolution's output with this number of taps: its groups, its bias and its
/// multiplier.
pub(crate) const fn scaled_groups<S: Storage>(taps: usize) -> usize {
    groups::<S>(taps).wrapping_add(2)
}

/// 16-bit weights (also 8-bit weights, widened) for 16-bit activations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wide;

impl Storage for Wide {
    type Activation = i16;
    const TAPS: usize = 2;

    #[inline]
    fn weight(group: u32, tap: usize) -> i32 {
        bytemuck::cast::<_, [i16; 2]>(group).get(tap).copied().map_or(0, i32::from)
    }

    fn put(group: &mut u32, tap: usize, weight: i16) {
        if let Some(slot) = bytemuck::cast_mut::<_, [i16; 2]>(group).get_mut(tap) {
            *slot = weight;
        }
    }
}

/// 8-bit weights for 16-bit activations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Packed16;

impl Storage for Packed16 {
    type Activation = i16;
    const TAPS: usize = 4;

    #[inline]
    fn weight(group: u32, tap: usize) -> i32 {
        let [zero, two, one, three] = bytemuck::cast::<_, [i8; 4]>(group);
        [zero, one, two, three].get(tap).copied().map_or(0, i32::from)
    }

    fn put(group: &mut u32, tap: usize, weight: i16) {
        let [zero, two, one, three] = bytemuck::cast_mut::<_, [i8; 4]>(group);
        if let Some(slot) = [zero, one, two, three].into_iter().nth(tap) {
            *slot = weight as i8;
        }
    }
}

/// 8-bit weights for 8-bit activations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Packed8;

impl Storage for Packed8 {
    type Activation = i8;
    const TAPS: usize = 4;

    #[inline]
    fn weight(group: u32, tap: usize) -> i32 {
        bytemuck::cast::<_, [i8; 4]>(group).get(tap).copied().map_or(0, i32::from)
    }

    fn put(group: &mut u32, tap: usize, weight: i16) {
        if let Some(slot) = bytemuck::cast_mut::<_, [i8; 4]>(group).get_mut(tap) {
            *slot = weight as i8;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn round_trip<S: Storage>() {
        let mut group = 0;
        for tap in 0..S::TAPS {
            S::put(&mut group, tap, tap as i16 - 2);
        }
        S::put(&mut group, S::TAPS, 99);
        for tap in 0..S::TAPS {
            assert_eq!(S::weight(group, tap), tap as i32 - 2);
        }
    }

    #[test]
    fn written_weights_are_read_back() {
        round_trip::<Wide>();
        round_trip::<Packed16>();
        round_trip::<Packed8>();
    }
}
