//! The weights of one layer, read in place, and the loops over its outputs.

use crate::activation::Activation;
use crate::error::ImageError;
use crate::image::{Reader, WeightForm};
use crate::kernel::{BLOCK, Blocks, Engine, Kernel, Quad, copy, finish};
use crate::storage::{Packed8, Packed16, Storage, Wide, groups};
use core::hash::{Hash, Hasher};
use core::ops::Range;

mod sealed {
    pub trait Sealed {}
    impl Sealed for super::Weights16<'_> {}
    impl Sealed for super::PackedWeights<'_> {}
}

/// What surrounds the products of a convolution.
#[derive(Clone, Copy, Debug)]
pub struct Scaling<'a, const OUT: usize> {
    /// Biases.
    pub biases: &'a [i32; OUT],
    /// Factors to the next layer's scale, times 2^32.
    pub multipliers: &'a [i32; OUT],
}

impl<'a, const OUT: usize> Scaling<'a, OUT> {
    /// Biases of the whole blocks.
    #[inline]
    fn block_biases(&self) -> &'a [[i32; BLOCK]] {
        self.biases.as_chunks().0
    }

    /// Multipliers of the whole blocks.
    #[inline]
    fn block_multipliers(&self) -> &'a [[i32; BLOCK]] {
        self.multipliers.as_chunks().0
    }

    /// Biases and multipliers of the outputs behind the blocks.
    #[inline]
    fn left(&self) -> impl Iterator<Item = (&'a i32, &'a i32)> + use<'a, OUT> {
        self.biases.as_chunks::<BLOCK>().1.iter().zip(self.multipliers.as_chunks::<BLOCK>().1)
    }
}

/// Weights of a layer in one form of storage: whole blocks of four outputs, then the outputs left over.
#[derive(Clone, Copy, Debug)]
pub struct Stored<'a, S: Storage> {
    quads: &'a [Quad],
    rows: &'a [u32],
    form: core::marker::PhantomData<S>,
}

/// Gives the place and the length of numbers in memory to a sum.
pub(crate) fn place<T>(numbers: &[T], sum: &mut impl Hasher) {
    sum.write_usize(numbers.as_ptr().addr());
    sum.write_usize(numbers.len());
}

impl<'a, S: Storage> Stored<'a, S> {
    fn constants(&self, sum: &mut impl Hasher) {
        place(self.quads, sum);
        place(self.rows, sum);
    }

    fn read(reader: &mut Reader<'a>, outputs: usize, taps: usize) -> Result<Self, ImageError> {
        let groups = groups::<S>(taps);
        Ok(Self {
            quads: reader.slice((outputs / BLOCK).wrapping_mul(groups))?,
            rows: reader.slice((outputs % BLOCK).wrapping_mul(groups))?,
            form: core::marker::PhantomData,
        })
    }

    fn weight(&self, output: usize, tap: usize, taps: usize) -> Option<i32> {
        let (group, groups) = (tap / S::TAPS, groups::<S>(taps));
        let quad = self.quads.chunks_exact(groups).nth(output / BLOCK);
        let word = match quad {
            Some(quad) => quad.get(group)?.get(output % BLOCK)?,
            None => self.rows.chunks_exact(groups).nth(output % BLOCK)?.get(group)?,
        };
        Some(S::weight(*word, tap % S::TAPS))
    }

    #[inline]
    fn pair<E: Engine + Kernel<S>, B: Activation, const IN: usize, const OUT: usize, const K: usize>(
        &self,
        scaling: &Scaling<'_, OUT>,
        columns: &[[S::Activation; IN]],
        [first, second]: [&mut [B; OUT]; 2],
    ) -> u32 {
        let mut clipped = 0u32;
        let (first, first_left) = first.as_chunks_mut::<BLOCK>();
        let (second, second_left) = second.as_chunks_mut::<BLOCK>();
        let quads = self.quads.chunks_exact(groups::<S>(K * IN));
        let outputs = first.iter_mut().zip(second);
        for ((quads, (biases, multipliers)), (first, second)) in
            quads.zip(scaling.block_biases().iter().zip(scaling.block_multipliers())).zip(outputs)
        {
            let mut sums = [*biases; 2];
            <E as Kernel<S>>::pair::<IN, K>(quads, columns, &mut sums);
            let [at_first, at_second] = sums;
            clipped = clipped.wrapping_add(finish::<E, B>(&at_first, multipliers, first));
            clipped = clipped.wrapping_add(finish::<E, B>(&at_second, multipliers, second));
        }
        for (columns, outputs) in [(columns.first_chunk(), first_left), (columns.last_chunk(), second_left)] {
            if let Some(columns) = columns {
                clipped = clipped.wrapping_add(self.left::<E, B, IN, OUT, K>(scaling, columns, outputs));
            }
        }
        clipped
    }

    #[inline]
    fn blocks<
        E: Engine + Kernel<S>,
        B: Activation,
        const IN: usize,
        const OUT: usize,
        const K: usize,
        const N: usize,
    >(
        &self,
        blocks: Range<usize>,
        scaling: &Scaling<'_, OUT>,
        columns: &[[S::Activation; IN]; K],
        outputs: &mut [[B; OUT]],
    ) -> u32 {
        let groups = groups::<S>(K * IN);
        let (start, end) = (blocks.start.wrapping_mul(groups), blocks.end.wrapping_mul(groups));
        let first = blocks.start;
        let blocks = Blocks {
            weights: self.quads.get(start..end).unwrap_or_default(),
            biases: scaling.block_biases().get(blocks.clone()).unwrap_or_default(),
            multipliers: scaling.block_multipliers().get(blocks).unwrap_or_default(),
        };
        <E as Kernel<S>>::blocks::<B, IN, OUT, K, N>(&blocks, first, columns, outputs)
    }

    #[inline]
    fn left<E: Engine + Kernel<S>, B: Activation, const IN: usize, const OUT: usize, const K: usize>(
        &self,
        scaling: &Scaling<'_, OUT>,
        columns: &[[S::Activation; IN]; K],
        outputs: &mut [B],
    ) -> u32 {
        let mut clipped = 0u32;
        let rows = self.rows.chunks_exact(groups::<S>(K * IN));
        for ((row, (&bias, &multiplier)), output) in rows.zip(scaling.left()).zip(outputs) {
            let sum = <E as Kernel<S>>::row::<IN, K>(row, columns, bias);
            clipped =
                clipped.wrapping_add(finish::<E, B>(&[sum], &[multiplier], core::slice::from_mut(output)));
        }
        clipped
    }

    #[inline]
    fn units<
        E: Engine + Kernel<S>,
        B: Activation,
        const IN: usize,
        const OUT: usize,
        const K: usize,
        const N: usize,
    >(
        &self,
        units: Range<usize>,
        scaling: &Scaling<'_, OUT>,
        columns: &[[S::Activation; IN]; K],
        outputs: &mut [[B; OUT]],
    ) -> u32 {
        let blocks = units.start..units.end.min(OUT / BLOCK);
        let clipped = self.blocks::<E, B, IN, OUT, K, N>(blocks, scaling, columns, outputs);
        if units.end <= OUT / BLOCK {
            return clipped;
        }
        let (_, left) = outputs.first_mut().map(|column| column.as_chunks_mut::<BLOCK>()).unwrap_or_default();
        let behind = self.left::<E, B, IN, OUT, K>(scaling, columns, left);
        copy::<B, OUT, N>(outputs, OUT / BLOCK * BLOCK..OUT);
        clipped.wrapping_add(behind)
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

/// Weights for activations of one width, in whichever form they are stored.
pub trait WeightsOf<'a, A: Activation>: sealed::Sealed + Copy + core::fmt::Debug {
    /// Takes the weights of `outputs` times `taps` from an image, stored in this form.
    #[doc(hidden)]
    fn read(
        reader: &mut Reader<'a>,
        form: WeightForm,
        outputs: usize,
        taps: usize,
    ) -> Result<Self, ImageError>;

    /// All outputs of a convolution at two neighbouring positions from `K + 1` columns; gives how many were clipped.
    fn pair<E: Engine, B: Activation, const IN: usize, const OUT: usize, const K: usize>(
        &self,
        scaling: &Scaling<'_, OUT>,
        columns: &[[A; IN]],
        outputs: [&mut [B; OUT]; 2],
    ) -> u32;

    /// Some units (blocks, then what is left over) of a convolution's outputs at one position, to the first of some columns and, unless `N` is 0, to
    /// the one `N` behind it; gives how many were clipped.
    fn units<E: Engine, B: Activation, const IN: usize, const OUT: usize, const K: usize, const N: usize>(
        &self,
        units: Range<usize>,
        scaling: &Scaling<'_, OUT>,
        columns: &[[A; IN]; K],
        outputs: &mut [[B; OUT]],
    ) -> u32;

    /// Adds a head's products to its sums.
    fn sums<E: Engine, const IN: usize, const OUT: usize, const K: usize>(
        &self,
        columns: &[[A; IN]; K],
        sums: &mut [i32; OUT],
    );

    /// Gives their form and where they lie to a sum.
    #[doc(hidden)]
    fn constants(&self, sum: &mut impl Hasher);

    /// Weight of an output at one of `taps`, if there is such a one.
    fn weight(&self, output: usize, tap: usize, taps: usize) -> Option<i32>;
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
    ) -> Result<Self, ImageError> {
        Ok(match form {
            WeightForm::Wide => Self::Wide(Stored::read(reader, outputs, taps)?),
            WeightForm::Packed => Self::Packed(Stored::read(reader, outputs, taps)?),
        })
    }

    #[inline]
    fn pair<E: Engine, B: Activation, const IN: usize, const OUT: usize, const K: usize>(
        &self,
        scaling: &Scaling<'_, OUT>,
        columns: &[[i16; IN]],
        outputs: [&mut [B; OUT]; 2],
    ) -> u32 {
        match self {
            Self::Wide(weights) => weights.pair::<E, B, IN, OUT, K>(scaling, columns, outputs),
            Self::Packed(weights) => weights.pair::<E, B, IN, OUT, K>(scaling, columns, outputs),
        }
    }

    #[inline]
    fn units<E: Engine, B: Activation, const IN: usize, const OUT: usize, const K: usize, const N: usize>(
        &self,
        units: Range<usize>,
        scaling: &Scaling<'_, OUT>,
        columns: &[[i16; IN]; K],
        outputs: &mut [[B; OUT]],
    ) -> u32 {
        match self {
            Self::Wide(weights) => weights.units::<E, B, IN, OUT, K, N>(units, scaling, columns, outputs),
            Self::Packed(weights) => weights.units::<E, B, IN, OUT, K, N>(units, scaling, columns, outputs),
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

    fn constants(&self, sum: &mut impl Hasher) {
        core::mem::discriminant(self).hash(sum);
        match self {
            Self::Wide(weights) => weights.constants(sum),
            Self::Packed(weights) => weights.constants(sum),
        }
    }

    fn weight(&self, output: usize, tap: usize, taps: usize) -> Option<i32> {
        match self {
            Self::Wide(weights) => weights.weight(output, tap, taps),
            Self::Packed(weights) => weights.weight(output, tap, taps),
        }
    }
}

/// Weights for 8-bit activations: 8 bits each.
#[derive(Clone, Copy, Debug)]
pub struct PackedWeights<'a>(Stored<'a, Packed8>);

impl<'a> WeightsOf<'a, i8> for PackedWeights<'a> {
    fn read(reader: &mut Reader<'a>, _: WeightForm, outputs: usize, taps: usize) -> Result<Self, ImageError> {
        // A shape with wide weights on 8-bit inputs is none.
        Stored::read(reader, outputs, taps).map(Self)
    }

    #[inline]
    fn pair<E: Engine, B: Activation, const IN: usize, const OUT: usize, const K: usize>(
        &self,
        scaling: &Scaling<'_, OUT>,
        columns: &[[i8; IN]],
        outputs: [&mut [B; OUT]; 2],
    ) -> u32 {
        self.0.pair::<E, B, IN, OUT, K>(scaling, columns, outputs)
    }

    #[inline]
    fn units<E: Engine, B: Activation, const IN: usize, const OUT: usize, const K: usize, const N: usize>(
        &self,
        units: Range<usize>,
        scaling: &Scaling<'_, OUT>,
        columns: &[[i8; IN]; K],
        outputs: &mut [[B; OUT]],
    ) -> u32 {
        self.0.units::<E, B, IN, OUT, K, N>(units, scaling, columns, outputs)
    }

    #[inline]
    fn sums<E: Engine, const IN: usize, const OUT: usize, const K: usize>(
        &self,
        columns: &[[i8; IN]; K],
        sums: &mut [i32; OUT],
    ) {
        self.0.sums::<E, IN, OUT, K>(columns, sums);
    }

    fn constants(&self, sum: &mut impl Hasher) {
        self.0.constants(sum);
    }

    fn weight(&self, output: usize, tap: usize, taps: usize) -> Option<i32> {
        self.0.weight(output, tap, taps)
    }
}
