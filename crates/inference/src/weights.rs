//! Weights of one layer, read in place, and the loops over its outputs.

use crate::activation::Activation;
use crate::image::{ImageError, Reader, WeightForm};
use crate::kernel::{BLOCK, Engine, Kernel, LayerOutcome, Quad, copy, finish, scaling};
use crate::storage::{Packed8, Packed16, Storage, Wide, groups, scaled_groups};
use core::hash::{Hash, Hasher};

mod sealed {
    pub trait Sealed {}
    impl Sealed for super::Weights16<'_> {}
    impl Sealed for super::PackedWeights<'_> {}
}

/// Words around the weights of an output.
#[doc(hidden)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Around {
    /// None, as in a head.
    Nothing,
    /// Bias before and multiplier after the weights, as in a convolution.
    Scaling,
}

impl Around {
    /// Number of words before the weights; the same number follows them.
    const fn words(self) -> usize {
        match self {
            Self::Nothing => 0,
            Self::Scaling => 1,
        }
    }
}

/// Weights of a layer in one storage form: complete blocks of four outputs, then the remaining
/// outputs.
#[derive(Clone, Copy, Debug)]
pub struct Stored<'a, S: Storage> {
    quads: &'a [Quad],
    rows: &'a [u32],
    form: core::marker::PhantomData<S>,
}

/// Hashes the address and the length of numbers in memory.
pub(crate) fn hash_place<T>(numbers: &[T], state: &mut impl Hasher) {
    state.write_usize(numbers.as_ptr().addr());
    state.write_usize(numbers.len());
}

impl<'a, S: Storage> Stored<'a, S> {
    fn hash_config(&self, state: &mut impl Hasher) {
        hash_place(self.quads, state);
        hash_place(self.rows, state);
    }

    /// Number of words of one output.
    const fn words(taps: usize, around: Around) -> usize {
        match around {
            Around::Nothing => groups::<S>(taps),
            Around::Scaling => scaled_groups::<S>(taps),
        }
    }

    fn read(
        reader: &mut Reader<'a>,
        outputs: usize,
        taps: usize,
        around: Around,
    ) -> Result<Self, ImageError> {
        let words = Self::words(taps, around);
        Ok(Self {
            quads: reader.slice((outputs / BLOCK).wrapping_mul(words))?,
            rows: reader.slice((outputs % BLOCK).wrapping_mul(words))?,
            form: core::marker::PhantomData,
        })
    }

    /// Returns a word of an output.
    fn word(&self, output: usize, index: usize, words: usize) -> Option<u32> {
        match self.quads.chunks_exact(words).nth(output / BLOCK) {
            Some(block) => block.get(index)?.get(output % BLOCK).copied(),
            None => self.rows.chunks_exact(words).nth(output % BLOCK)?.get(index).copied(),
        }
    }

    fn weight(&self, output: usize, tap: usize, taps: usize, around: Around) -> Option<i32> {
        let index = around.words().wrapping_add(tap / S::TAPS);
        let word = self.word(output, index, Self::words(taps, around))?;
        Some(S::weight(word, tap % S::TAPS))
    }

    fn around(&self, output: usize, taps: usize) -> Option<[i32; 2]> {
        let words = Self::words(taps, Around::Scaling);
        let [bias, multiplier] = [0, words.wrapping_sub(1)].map(|index| self.word(output, index, words));
        Some([bias?.cast_signed(), multiplier?.cast_signed()])
    }

    #[inline]
    fn pair<E: Engine + Kernel<S>, B: Activation, const IN: usize, const OUT: usize, const K: usize>(
        &self,
        columns: &[[S::Activation; IN]],
        [first, second]: [&mut [B; OUT]; 2],
    ) -> u32 {
        let mut clipped = 0u32;
        let (first, first_left) = first.as_chunks_mut::<BLOCK>();
        let (second, second_left) = second.as_chunks_mut::<BLOCK>();
        let blocks = self.quads.chunks_exact(scaled_groups::<S>(K * IN));
        for (block, (first, second)) in blocks.zip(first.iter_mut().zip(second)) {
            let Some((biases, weights, multipliers)) = scaling(block) else { break };
            let mut sums = [biases; 2];
            <E as Kernel<S>>::pair::<IN, K>(weights, columns, &mut sums);
            let [at_first, at_second] = sums;
            clipped = clipped.wrapping_add(finish::<E, B>(&at_first, &multipliers, first));
            clipped = clipped.wrapping_add(finish::<E, B>(&at_second, &multipliers, second));
        }
        for (columns, outputs) in [(columns.first_chunk(), first_left), (columns.last_chunk(), second_left)] {
            if let Some(columns) = columns {
                clipped = clipped.wrapping_add(self.left::<E, B, IN, K>(columns, outputs));
            }
        }
        clipped
    }

    #[inline]
    fn left<E: Engine + Kernel<S>, B: Activation, const IN: usize, const K: usize>(
        &self,
        columns: &[[S::Activation; IN]; K],
        outputs: &mut [B],
    ) -> u32 {
        let mut clipped = 0u32;
        let rows = self.rows.chunks_exact(scaled_groups::<S>(K * IN));
        for (row, output) in rows.zip(outputs) {
            let [bias, weights @ .., multiplier] = row else { break };
            let sum = <E as Kernel<S>>::row::<IN, K>(weights, columns, bias.cast_signed());
            let output = core::slice::from_mut(output);
            clipped = clipped.wrapping_add(finish::<E, B>(&[sum], &[multiplier.cast_signed()], output));
        }
        clipped
    }

    #[inline]
    fn outputs<
        E: Engine + Kernel<S>,
        B: Activation,
        const IN: usize,
        const OUT: usize,
        const K: usize,
        const N: usize,
    >(
        &self,
        columns: &[[S::Activation; IN]; K],
        outputs: &mut [[B; OUT]],
    ) -> LayerOutcome {
        let groups = scaled_groups::<S>(K * IN);
        let blocks = self.quads.get(..(OUT / BLOCK).wrapping_mul(groups)).unwrap_or_default();
        let outcome = <E as Kernel<S>>::blocks::<B, IN, OUT, K, N>(blocks, columns, outputs);
        if OUT.is_multiple_of(BLOCK) {
            return outcome;
        }
        let (_, left) = outputs.first_mut().map(|column| column.as_chunks_mut::<BLOCK>()).unwrap_or_default();
        let clipped = self.left::<E, B, IN, K>(columns, left);
        copy::<B, OUT, N>(outputs, OUT / BLOCK * BLOCK..OUT);
        LayerOutcome { clipped: outcome.clipped.wrapping_add(clipped), ..outcome }
    }

    #[inline]
    fn sums<E: Engine + Kernel<S>, const IN: usize, const OUT: usize, const K: usize>(
        &self,
        columns: &[[S::Activation; IN]; K],
        sums: &mut [i32; OUT],
    ) {
        let groups = groups::<S>(K * IN);
        let (blocks, left) = sums.as_chunks_mut::<BLOCK>();
        for (quads, sums) in self.quads.chunks_exact(groups).zip(blocks) {
            <E as Kernel<S>>::block::<IN, K>(quads, columns, sums);
        }
        for (row, sum) in self.rows.chunks_exact(groups).zip(left) {
            *sum = <E as Kernel<S>>::row::<IN, K>(row, columns, *sum);
        }
    }
}

/// Weights for activations of one width, in any storage form.
pub trait WeightsOf<'a, A: Activation>: sealed::Sealed + Copy + core::fmt::Debug {
    /// Reads the weights of `outputs` times `taps` from an image, stored in this form.
    #[doc(hidden)]
    fn read(
        reader: &mut Reader<'a>,
        form: WeightForm,
        outputs: usize,
        taps: usize,
        around: Around,
    ) -> Result<Self, ImageError>;

    /// Computes all outputs of a convolution at two neighbouring positions from `K + 1` columns;
    /// returns the number of clipped activations.
    fn pair<E: Engine, B: Activation, const IN: usize, const OUT: usize, const K: usize>(
        &self,
        columns: &[[A; IN]],
        outputs: [&mut [B; OUT]; 2],
    ) -> u32;

    /// Computes all outputs of a convolution at one position. They are written to the first of the
    /// columns in `outputs` and, unless `N` is 0, also to the column `N` places after it.
    fn outputs<E: Engine, B: Activation, const IN: usize, const OUT: usize, const K: usize, const N: usize>(
        &self,
        columns: &[[A; IN]; K],
        outputs: &mut [[B; OUT]],
    ) -> LayerOutcome;

    /// Adds a head's products to its sums.
    fn sums<E: Engine, const IN: usize, const OUT: usize, const K: usize>(
        &self,
        columns: &[[A; IN]; K],
        sums: &mut [i32; OUT],
    );

    /// Hashes the storage form and the addresses.
    #[doc(hidden)]
    fn hash_config(&self, state: &mut impl Hasher);

    /// Returns the weight of an output at one of `taps`, if it exists.
    #[doc(hidden)]
    fn weight(&self, output: usize, tap: usize, taps: usize, around: Around) -> Option<i32>;

    /// Returns bias and multiplier of a convolution's output, if it exists.
    #[doc(hidden)]
    fn around(&self, output: usize, taps: usize) -> Option<[i32; 2]>;
}

/// Activation that a layer may take as input: `i16` or `i8`.
pub trait LayerInput: Activation {
    /// Forms in which the weights of a layer with such inputs may be stored.
    type Weights<'a>: WeightsOf<'a, Self>;
}

impl LayerInput for i16 {
    type Weights<'a> = Weights16<'a>;
}

impl LayerInput for i8 {
    type Weights<'a> = PackedWeights<'a>;
}

/// Weights for 16-bit activations.
#[derive(Clone, Copy, Debug)]
pub enum Weights16<'a> {
    /// 16 bits each.
    Wide(Stored<'a, Wide>),
    /// 8 bits each.
    Packed(Stored<'a, Packed16>),
}

impl<'a> WeightsOf<'a, i16> for Weights16<'a> {
    fn read(
        reader: &mut Reader<'a>,
        form: WeightForm,
        outputs: usize,
        taps: usize,
        around: Around,
    ) -> Result<Self, ImageError> {
        Ok(match form {
            WeightForm::Wide => Self::Wide(Stored::read(reader, outputs, taps, around)?),
            WeightForm::Packed => Self::Packed(Stored::read(reader, outputs, taps, around)?),
        })
    }

    #[inline]
    fn pair<E: Engine, B: Activation, const IN: usize, const OUT: usize, const K: usize>(
        &self,
        columns: &[[i16; IN]],
        outputs: [&mut [B; OUT]; 2],
    ) -> u32 {
        match self {
            Self::Wide(weights) => weights.pair::<E, B, IN, OUT, K>(columns, outputs),
            Self::Packed(weights) => weights.pair::<E, B, IN, OUT, K>(columns, outputs),
        }
    }

    #[inline]
    fn outputs<
        E: Engine,
        B: Activation,
        const IN: usize,
        const OUT: usize,
        const K: usize,
        const N: usize,
    >(
        &self,
        columns: &[[i16; IN]; K],
        outputs: &mut [[B; OUT]],
    ) -> LayerOutcome {
        match self {
            Self::Wide(weights) => weights.outputs::<E, B, IN, OUT, K, N>(columns, outputs),
            Self::Packed(weights) => weights.outputs::<E, B, IN, OUT, K, N>(columns, outputs),
        }
    }

    #[inline]
    fn sums<E: Engine, const IN: usize, const OUT: usize, const K: usize>(
        &self,
        columns: &[[i16; IN]; K],
        sums: &mut [i32; OUT],
    ) {
        match self {
            Self::Wide(weights) => weights.sums::<E, IN, OUT, K>(columns, sums),
            Self::Packed(weights) => weights.sums::<E, IN, OUT, K>(columns, sums),
        }
    }

    fn hash_config(&self, state: &mut impl Hasher) {
        core::mem::discriminant(self).hash(state);
        match self {
            Self::Wide(weights) => weights.hash_config(state),
            Self::Packed(weights) => weights.hash_config(state),
        }
    }

    fn weight(&self, output: usize, tap: usize, taps: usize, around: Around) -> Option<i32> {
        match self {
            Self::Wide(weights) => weights.weight(output, tap, taps, around),
            Self::Packed(weights) => weights.weight(output, tap, taps, around),
        }
    }

    fn around(&self, output: usize, taps: usize) -> Option<[i32; 2]> {
        match self {
            Self::Wide(weights) => weights.around(output, taps),
            Self::Packed(weights) => weights.around(output, taps),
        }
    }
}

/// Weights for 8-bit activations: 8 bits each.
#[derive(Clone, Copy, Debug)]
pub struct PackedWeights<'a>(Stored<'a, Packed8>);

impl<'a> WeightsOf<'a, i8> for PackedWeights<'a> {
    fn read(
        reader: &mut Reader<'a>,
        _: WeightForm,
        outputs: usize,
        taps: usize,
        around: Around,
    ) -> Result<Self, ImageError> {
        // Wide weights on 8-bit inputs are not a valid shape.
        Stored::read(reader, outputs, taps, around).map(Self)
    }

    #[inline]
    fn pair<E: Engine, B: Activation, const IN: usize, const OUT: usize, const K: usize>(
        &self,
        columns: &[[i8; IN]],
        outputs: [&mut [B; OUT]; 2],
    ) -> u32 {
        self.0.pair::<E, B, IN, OUT, K>(columns, outputs)
    }

    #[inline]
    fn outputs<
        E: Engine,
        B: Activation,
        const IN: usize,
        const OUT: usize,
        const K: usize,
        const N: usize,
    >(
        &self,
        columns: &[[i8; IN]; K],
        outputs: &mut [[B; OUT]],
    ) -> LayerOutcome {
        self.0.outputs::<E, B, IN, OUT, K, N>(columns, outputs)
    }

    #[inline]
    fn sums<E: Engine, const IN: usize, const OUT: usize, const K: usize>(
        &self,
        columns: &[[i8; IN]; K],
        sums: &mut [i32; OUT],
    ) {
        self.0.sums::<E, IN, OUT, K>(columns, sums);
    }

    fn hash_config(&self, state: &mut impl Hasher) {
        self.0.hash_config(state);
    }

    fn weight(&self, output: usize, tap: usize, taps: usize, around: Around) -> Option<i32> {
        self.0.weight(output, tap, taps, around)
    }

    fn around(&self, output: usize, taps: usize) -> Option<[i32; 2]> {
        self.0.around(output, taps)
    }
}
