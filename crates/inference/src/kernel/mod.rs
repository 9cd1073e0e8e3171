//! Dot products: the only place where multiplications are counted.
//!
//! Channels-last columns are contiguous, so the taps of an output are one slice of memory and a convolution is nothing but
//! dot products. Three shapes do all of it: four outputs at two neighbouring positions, four outputs at one position,
//! one output at one position.
//!
//! [`Portable`] is safe Rust and the oracle; `Simd` runs on hosts and `CortexM` on cores with the DSP instructions. Whole numbers of 32 bits add up to the same sum in any order, and the loader has proven
//! that none overflows ([`crate::image::prove`]): so all of them give the same bits, which tests show on every one of them.

use crate::activation::Activation;
use crate::storage::{Packed8, Packed16, Storage, Wide, scaled_groups};
use core::ops::Range;

#[cfg(pintle_dsp)]
pub mod cortex_m;
pub mod portable;
#[cfg(not(target_os = "none"))]
pub mod simd;

pub use portable::Portable;

/// Outputs computed together.
pub const BLOCK: usize = 4;

/// Weights of four outputs in one group of taps.
pub type Quad = [u32; BLOCK];

/// What a layer's outputs tell beside themselves.
#[must_use]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Done {
    /// Activations clipped at full scale.
    pub clipped: u32,
    /// Not 0 where the way through the layer's numbers did not end where they end: the outputs are not to be trusted.
    pub astray: u32,
}

/// Dot products with weights of one form of storage.
///
/// `weights` are [`crate::storage::groups`]`(K * IN)` groups; with fewer, the sums are not what they should be, but nothing
/// else happens.
pub trait Kernel<S: Storage> {
    /// Adds four outputs at each of two neighbouring positions; `columns` are `K + 1`.
    fn pair<const IN: usize, const K: usize>(
        weights: &[Quad],
        columns: &[[S::Activation; IN]],
        sums: &mut [[i32; BLOCK]; 2],
    );

    /// Adds four outputs at one position.
    fn block<const IN: usize, const K: usize>(
        weights: &[Quad],
        columns: &[[S::Activation; IN]; K],
        sums: &mut [i32; BLOCK],
    );

    /// Adds one output at one position to `sum`.
    fn row<const IN: usize, const K: usize>(
        weights: &[u32],
        columns: &[[S::Activation; IN]; K],
        sum: i32,
    ) -> i32;

    /// The outputs of some blocks at one position, scaled, clipped and stored, the `first` of them and on, in the first of some columns and, unless `N`
    /// is 0, in the one `N` behind it. Each block is [`scaled_groups`]`(K * IN)` long.
    #[inline]
    fn blocks<B: Activation, const IN: usize, const OUT: usize, const K: usize, const N: usize>(
        blocks: &[Quad],
        first: usize,
        columns: &[[S::Activation; IN]; K],
        outputs: &mut [[B; OUT]],
    ) -> Done
    where
        Self: Engine + Sized,
    {
        blockwise::<Self, S, B, IN, OUT, K, N>(blocks, first, columns, outputs)
    }
}

/// [`Kernel::blocks`] one block after the other.
#[inline]
fn blockwise<
    E: Engine + Kernel<S>,
    S: Storage,
    B: Activation,
    const IN: usize,
    const OUT: usize,
    const K: usize,
    const N: usize,
>(
    blocks: &[Quad],
    first: usize,
    columns: &[[S::Activation; IN]; K],
    outputs: &mut [[B; OUT]],
) -> Done {
    let mut clipped = 0u32;
    let (own, _) = outputs.first_mut().map(|column| column.as_chunks_mut::<BLOCK>()).unwrap_or_default();
    let own = own.get_mut(first..).unwrap_or_default();
    let blocks = blocks.chunks_exact(scaled_groups::<S>(K * IN));
    let start = first.wrapping_mul(BLOCK);
    let end = start.wrapping_add(blocks.len().wrapping_mul(BLOCK));
    for (block, outputs) in blocks.zip(own) {
        let Some((mut sums, weights, multipliers)) = scaling(block) else { break };
        <E as Kernel<S>>::block::<IN, K>(weights, columns, &mut sums);
        clipped = clipped.wrapping_add(finish::<E, B>(&sums, &multipliers, outputs));
    }
    copy::<B, OUT, N>(outputs, start..end);
    Done { clipped, astray: 0 }
}

/// A block's biases, weights and multipliers.
#[inline]
pub(crate) fn scaling(block: &[Quad]) -> Option<([i32; BLOCK], &[Quad], [i32; BLOCK])> {
    let [biases, weights @ .., multipliers] = block else { return None };
    Some((biases.map(u32::cast_signed), weights, multipliers.map(u32::cast_signed)))
}

/// Copies some outputs of the first column to the one `N` behind it, unless that is itself.
#[inline]
pub(crate) fn copy<B: Copy, const OUT: usize, const N: usize>(
    columns: &mut [[B; OUT]],
    outputs: Range<usize>,
) {
    if let Some((first, behind)) = columns.split_first_mut()
        && let Some(second) = behind.get_mut(N.wrapping_sub(1))
        && let (Some(second), Some(first)) = (second.get_mut(outputs.clone()), first.get(outputs))
    {
        second.copy_from_slice(first);
    }
}

/// Scales and stores sums; gives how many were clipped at full scale.
#[inline]
pub(crate) fn finish<E: Engine, B: Activation>(sums: &[i32], multipliers: &[i32], outputs: &mut [B]) -> u32 {
    let mut clipped = 0u32;
    for ((&sum, &multiplier), slot) in sums.iter().zip(multipliers).zip(outputs) {
        let value = E::requantise(sum, multiplier);
        clipped = clipped.wrapping_add(u32::from(value > B::MAX));
        *slot = B::clip(value);
    }
    clipped
}

/// Kernels for every form of storage, and the step to the next layer's scale.
pub trait Engine: Kernel<Wide> + Kernel<Packed16> + Kernel<Packed8> {
    /// A sum times `multiplier / 2^32`, rounded to nearest, halves up.
    #[inline]
    fn requantise(sum: i32, multiplier: i32) -> i32 {
        let product = i64::from(sum).wrapping_mul(i64::from(multiplier));
        (product.wrapping_add(1 << 31) >> 32) as i32
    }
}

/// Has the compiler put a value into memory, and read it from there from here on: what it holds in registers meanwhile does not count.
#[inline]
pub fn read_anew<T>(value: &mut T) {
    #[cfg(pintle_dsp)]
    cortex_m::read_anew(value);
    // The same, by a pointer that is itself put into memory.
    #[cfg(not(pintle_dsp))]
    core::hint::black_box(value);
}

/// Not 0 where two columns of words differ.
#[inline]
pub(crate) fn difference(first: &[u32], second: &[u32]) -> u32 {
    #[cfg(pintle_dsp)]
    {
        let found = quads_difference::<2>(first, second).or_else(|| quads_difference::<1>(first, second));
        if let Some(difference) = found {
            return difference;
        }
    }
    first.iter().zip(second).fold(0, |found, (first, second)| found | (first ^ second))
}

/// The same where a column has exactly so many times four words.
#[cfg(pintle_dsp)]
#[inline]
fn quads_difference<const QUADS: usize>(first: &[u32], second: &[u32]) -> Option<u32> {
    fn quads<const QUADS: usize>(words: &[u32]) -> Option<&[[u32; 4]; QUADS]> {
        if words.len() == 4 * QUADS { words.as_chunks().0.try_into().ok() } else { None }
    }
    Some(cortex_m::difference::<QUADS>(quads(first)?, quads(second)?))
}

/// The fastest engine of this target.
#[cfg(pintle_dsp)]
pub type Native = cortex_m::CortexM;
/// The fastest engine of this target.
#[cfg(not(target_os = "none"))]
pub type Native = simd::Simd;
/// The fastest engine of this target.
#[cfg(all(target_os = "none", not(pintle_dsp)))]
pub type Native = Portable;

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn requantise_rounds_to_nearest(sum in any::<i32>(), multiplier in 1..i32::MAX) {
            let exact = f64::from(sum) * f64::from(multiplier) / 4_294_967_296.0;
            prop_assert!((f64::from(Portable::requantise(sum, multiplier)) - exact).abs() <= 0.5);
        }
    }
}
