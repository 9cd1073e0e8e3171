//! Traits of the kernels and what all engines share: scaling, clipping and storing of sums.

use crate::activation::Activation;
use crate::storage::{Packed8, Packed16, Storage, Wide, scaled_groups};
use core::ops::Range;

/// Number of outputs computed together.
pub const BLOCK: usize = 4;

/// Weights of four outputs in one group of taps.
pub type Quad = [u32; BLOCK];

/// Result of computing a layer's outputs, apart from the outputs.
#[must_use]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LayerOutcome {
    /// Number of activations clipped at full scale.
    pub(crate) clipped: u32,
    /// Non-zero if the weight pointer did not end at the end of the layer: the outputs are wrong.
    pub(crate) corruption: u32,
}

/// Dot products with weights of one storage form.
///
/// `weights` are [`crate::storage::groups`]`(K * IN)` groups; with fewer groups the sums are wrong,
/// but no memory is violated.
pub trait Kernel<S: Storage> {
    /// Adds four outputs at each of two neighbouring positions; `columns` has `K + 1` columns.
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

    /// Computes the outputs of some blocks at one position: scales, clips and stores them in the
    /// first of the columns in `outputs` and, unless `N` is 0, also in the column `N` places after
    /// it. Each block is [`scaled_groups`]`(K * IN)` long.
    #[inline]
    fn blocks<B: Activation, const IN: usize, const OUT: usize, const K: usize, const N: usize>(
        blocks: &[Quad],
        columns: &[[S::Activation; IN]; K],
        outputs: &mut [[B; OUT]],
    ) -> LayerOutcome
    where
        Self: Engine + Sized,
    {
        blockwise::<Self, S, B, IN, OUT, K, N>(blocks, columns, outputs)
    }
}

/// [`Kernel::blocks`], one block after the other.
#[inline]
pub(super) fn blockwise<
    E: Engine + Kernel<S>,
    S: Storage,
    B: Activation,
    const IN: usize,
    const OUT: usize,
    const K: usize,
    const N: usize,
>(
    blocks: &[Quad],
    columns: &[[S::Activation; IN]; K],
    outputs: &mut [[B; OUT]],
) -> LayerOutcome {
    let mut clipped = 0u32;
    let (own, _) = outputs.first_mut().map(|column| column.as_chunks_mut::<BLOCK>()).unwrap_or_default();
    let blocks = blocks.chunks_exact(scaled_groups::<S>(K * IN));
    let count = blocks.len().wrapping_mul(BLOCK);
    for (block, outputs) in blocks.zip(own) {
        let Some((mut sums, weights, multipliers)) = scaling(block) else { break };
        <E as Kernel<S>>::block::<IN, K>(weights, columns, &mut sums);
        clipped = clipped.wrapping_add(finish::<E, B>(&sums, &multipliers, outputs));
    }
    copy::<B, OUT, N>(outputs, 0..count);
    LayerOutcome { clipped, corruption: 0 }
}

/// Splits a block into biases, weights and multipliers.
#[inline]
pub(crate) fn scaling(block: &[Quad]) -> Option<([i32; BLOCK], &[Quad], [i32; BLOCK])> {
    let [biases, weights @ .., multipliers] = block else { return None };
    Some((biases.map(u32::cast_signed), weights, multipliers.map(u32::cast_signed)))
}

/// Copies some outputs of the first column to the column `N` places after it; nothing if `N` is 0.
#[inline]
pub(crate) fn copy<B: Copy, const OUT: usize, const N: usize>(
    columns: &mut [[B; OUT]],
    outputs: Range<usize>,
) {
    if let Some((first, others)) = columns.split_first_mut()
        && let Some(second) = others.get_mut(N.wrapping_sub(1))
        && let (Some(second), Some(first)) = (second.get_mut(outputs.clone()), first.get(outputs))
    {
        second.copy_from_slice(first);
    }
}

/// Scales and stores sums; returns the number clipped at full scale.
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

/// Kernels for every storage form, and the conversion to the next layer's scale.
pub trait Engine: Kernel<Wide> + Kernel<Packed16> + Kernel<Packed8> {
    /// Returns a sum times `multiplier / 2^32`, rounded to nearest, halves up.
    #[inline]
    fn requantise(sum: i32, multiplier: i32) -> i32 {
        let product = i64::from(sum).wrapping_mul(i64::from(multiplier));
        (product.wrapping_add(1 << 31) >> 32) as i32
    }
}
