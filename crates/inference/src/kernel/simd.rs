//! Kernels with the host's 128-bit registers.
//!
//! Memory holds four outputs' pairs of weights side by side, as a multiply-add of pairs needs them
//! (`pmaddwd` of SSE2 or its NEON equivalent): eight products per instruction at one position. The
//! crate `wide` offers it on every host through safe functions.

use super::engine::{BLOCK, Engine, Kernel, Quad};
use super::portable::Portable;
use crate::storage::{Packed8, Packed16, Storage, Wide};
use wide::{i16x8, i32x4};

/// Engine of hosts.
#[derive(Clone, Copy, Debug)]
pub struct Simd;

impl Engine for Simd {}

/// Sums of the products of four groups of weights with one group of activations.
trait Multiply: Storage {
    /// Activations of one group; those past the end are 0.
    type Inputs: Copy;
    fn inputs(taps: &[Self::Activation]) -> Self::Inputs;
    fn multiply(quad: Quad, inputs: Self::Inputs) -> i32x4;
}

/// Returns two activations repeated in every lane of 32 bits.
#[inline]
fn both(first: i16, second: i16) -> i16x8 {
    bytemuck::cast([[first, second]; BLOCK])
}

/// Returns bytes 0 and 2 of every lane, widened.
#[inline]
fn even(bytes: i16x8) -> i16x8 {
    (bytes << 8) >> 8
}

/// Returns bytes 1 and 3 of every lane, widened.
#[inline]
fn odd(bytes: i16x8) -> i16x8 {
    bytes >> 8
}

impl Multiply for Wide {
    type Inputs = i16x8;

    #[inline]
    fn inputs(taps: &[i16]) -> i16x8 {
        match *taps {
            [first, second, ..] => both(first, second),
            [first] => both(first, 0),
            [] => i16x8::ZERO,
        }
    }

    #[inline]
    fn multiply(quad: Quad, inputs: i16x8) -> i32x4 {
        bytemuck::cast::<_, i16x8>(quad).dot(inputs)
    }
}

impl Multiply for Packed16 {
    type Inputs = [i16x8; 2];

    #[inline]
    fn inputs(taps: &[i16]) -> [i16x8; 2] {
        [Wide::inputs(taps), Wide::inputs(taps.get(2..).unwrap_or_default())]
    }

    #[inline]
    fn multiply(quad: Quad, [first, second]: [i16x8; 2]) -> i32x4 {
        let bytes = bytemuck::cast(quad);
        even(bytes).dot(first) + odd(bytes).dot(second)
    }
}

impl Multiply for Packed8 {
    type Inputs = [i16x8; 2];

    #[inline]
    fn inputs(taps: &[i8]) -> [i16x8; 2] {
        let mut four = [0; 4];
        four.iter_mut().zip(taps).for_each(|(slot, &tap)| *slot = tap);
        let bytes = bytemuck::cast([four; BLOCK]);
        [even(bytes), odd(bytes)]
    }

    #[inline]
    fn multiply(quad: Quad, inputs: [i16x8; 2]) -> i32x4 {
        Packed16::multiply(quad, inputs)
    }
}

impl<S: Multiply> Kernel<S> for Simd {
    #[inline]
    fn pair<const IN: usize, const K: usize>(
        weights: &[Quad],
        columns: &[[S::Activation; IN]],
        sums: &mut [[i32; BLOCK]; 2],
    ) {
        let (Some(first), Some(second)) = (columns.first_chunk::<K>(), columns.last_chunk::<K>()) else {
            return;
        };
        let [mut at_first, mut at_second] = sums.map(bytemuck::cast::<_, i32x4>);
        let (first, second) = (first.as_flattened(), second.as_flattened());
        for ((&quad, first), second) in weights.iter().zip(first.chunks(S::TAPS)).zip(second.chunks(S::TAPS))
        {
            at_first += S::multiply(quad, S::inputs(first));
            at_second += S::multiply(quad, S::inputs(second));
        }
        *sums = [bytemuck::cast(at_first), bytemuck::cast(at_second)];
    }

    #[inline]
    fn block<const IN: usize, const K: usize>(
        weights: &[Quad],
        columns: &[[S::Activation; IN]; K],
        sums: &mut [i32; BLOCK],
    ) {
        let mut all = bytemuck::cast::<_, i32x4>(*sums);
        for (&quad, inputs) in weights.iter().zip(columns.as_flattened().chunks(S::TAPS)) {
            all += S::multiply(quad, S::inputs(inputs));
        }
        *sums = bytemuck::cast(all);
    }

    #[inline]
    fn row<const IN: usize, const K: usize>(
        weights: &[u32],
        columns: &[[S::Activation; IN]; K],
        sum: i32,
    ) -> i32 {
        // The compiler vectorises the plain loop over one output.
        <Portable as Kernel<S>>::row(weights, columns, sum)
    }
}
