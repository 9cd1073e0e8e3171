//! The weights of one layer, read in place.

use crate::activation::Activation;
use crate::error::ImageError;
use crate::image::{LayerName, Reader, WeightForm};
use crate::kernel::{BLOCK, Engine, Kernel, Quad};
use crate::storage::{Packed8, Packed16, Storage, Wide, groups};

mod sealed {
    pub trait Sealed {}
    impl Sealed for super::Weights16<'_> {}
    impl Sealed for super::PackedWeights<'_> {}
}

/// Weights of a layer in one form of storage: whole blocks of four outputs, then the outputs left over.
#[derive(Clone, Copy, Debug)]
pub struct Stored<'a, S: Storage> {
    quads: &'a [Quad<S>],
    rows: &'a [S::Group],
    groups: usize,
}

impl<'a, S: Storage> Stored<'a, S> {
    fn read(reader: &mut Reader<'a>, outputs: usize, taps: usize) -> Result<Self, ImageError> {
        let groups = groups::<S>(taps);
        Ok(Self {
            quads: reader.slice(outputs / BLOCK * groups)?,
            rows: reader.slice(outputs % BLOCK * groups)?,
            groups,
        })
    }

    fn quad(&self, block: usize) -> &'a [Quad<S>] {
        let start = block.wrapping_mul(self.groups);
        self.quads.get(start..start.wrapping_add(self.groups)).unwrap_or_default()
    }

    fn row(&self, index: usize) -> &'a [S::Group] {
        let start = index.wrapping_mul(self.groups);
        self.rows.get(start..start.wrapping_add(self.groups)).unwrap_or_default()
    }

    fn weight(&self, output: usize, tap: usize) -> Option<i32> {
        let (group, tap) = (tap / S::TAPS, tap % S::TAPS);
        let quads = self.quads.len() / self.groups.max(1) * BLOCK;
        let group = match output.checked_sub(quads) {
            None => self.quad(output / BLOCK).get(group)?.get(output % BLOCK)?,
            Some(left) => self.row(left).get(group)?,
        };
        Some(S::weight(*group, tap))
    }
}

/// Weights for activations of one width, in whichever form they are stored.
pub trait WeightsOf<'a, A: Activation>: sealed::Sealed + Copy + core::fmt::Debug {
    /// Takes the weights of `outputs` times `taps` from an image, stored in this form.
    #[doc(hidden)]
    fn read(
        reader: &mut Reader<'a>,
        layer: LayerName,
        form: WeightForm,
        outputs: usize,
        taps: usize,
    ) -> Result<Self, ImageError>;

    /// Adds the four outputs of a block at two positions; see [`Kernel::pair`].
    fn pair<E: Engine, const IN: usize, const K: usize>(
        &self,
        block: usize,
        columns: &[[A; IN]],
        sums: &mut [[i32; BLOCK]; 2],
    );

    /// Adds the four outputs of a block at one position.
    fn block<E: Engine, const IN: usize, const K: usize>(
        &self,
        block: usize,
        columns: &[[A; IN]; K],
        sums: &mut [i32; BLOCK],
    );

    /// Adds one of the outputs that are left over behind the blocks.
    fn row<E: Engine, const IN: usize, const K: usize>(
        &self,
        index: usize,
        columns: &[[A; IN]; K],
        sum: i32,
    ) -> i32;

    /// Weight of an output at a tap, if there is such a one.
    fn weight(&self, output: usize, tap: usize) -> Option<i32>;
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
        _: LayerName,
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
    fn pair<E: Engine, const IN: usize, const K: usize>(
        &self,
        block: usize,
        columns: &[[i16; IN]],
        sums: &mut [[i32; BLOCK]; 2],
    ) {
        match self {
            Self::Wide(weights) => <E as Kernel<Wide>>::pair::<IN, K>(weights.quad(block), columns, sums),
            Self::Packed(weights) => <E as Kernel<Packed16>>::pair::<IN, K>(weights.quad(block), columns, sums),
        }
    }

    #[inline]
    fn block<E: Engine, const IN: usize, const K: usize>(
        &self,
        block: usize,
        columns: &[[i16; IN]; K],
        sums: &mut [i32; BLOCK],
    ) {
        match self {
            Self::Wide(weights) => <E as Kernel<Wide>>::block(weights.quad(block), columns, sums),
            Self::Packed(weights) => <E as Kernel<Packed16>>::block(weights.quad(block), columns, sums),
        }
    }

    #[inline]
    fn row<E: Engine, const IN: usize, const K: usize>(
        &self,
        index: usize,
        columns: &[[i16; IN]; K],
        sum: i32,
    ) -> i32 {
        match self {
            Self::Wide(weights) => <E as Kernel<Wide>>::row(weights.row(index), columns, sum),
            Self::Packed(weights) => <E as Kernel<Packed16>>::row(weights.row(index), columns, sum),
        }
    }

    fn weight(&self, output: usize, tap: usize) -> Option<i32> {
        match self {
            Self::Wide(weights) => weights.weight(output, tap),
            Self::Packed(weights) => weights.weight(output, tap),
        }
    }
}

/// Weights for 8-bit activations: 8 bits each.
#[derive(Clone, Copy, Debug)]
pub struct PackedWeights<'a>(Stored<'a, Packed8>);

impl<'a> WeightsOf<'a, i8> for PackedWeights<'a> {
    fn read(
        reader: &mut Reader<'a>,
        layer: LayerName,
        form: WeightForm,
        outputs: usize,
        taps: usize,
    ) -> Result<Self, ImageError> {
        match form {
            WeightForm::Packed => Stored::read(reader, outputs, taps).map(Self),
            WeightForm::Wide => Err(ImageError::Form { layer }),
        }
    }

    #[inline]
    fn pair<E: Engine, const IN: usize, const K: usize>(
        &self,
        block: usize,
        columns: &[[i8; IN]],
        sums: &mut [[i32; BLOCK]; 2],
    ) {
        <E as Kernel<Packed8>>::pair::<IN, K>(self.0.quad(block), columns, sums);
    }

    #[inline]
    fn block<E: Engine, const IN: usize, const K: usize>(
        &self,
        block: usize,
        columns: &[[i8; IN]; K],
        sums: &mut [i32; BLOCK],
    ) {
        <E as Kernel<Packed8>>::block(self.0.quad(block), columns, sums);
    }

    #[inline]
    fn row<E: Engine, const IN: usize, const K: usize>(
        &self,
        index: usize,
        columns: &[[i8; IN]; K],
        sum: i32,
    ) -> i32 {
        <E as Kernel<Packed8>>::row(self.0.row(index), columns, sum)
    }

    fn weight(&self, output: usize, tap: usize) -> Option<i32> {
        self.0.weight(output, tap)
    }
}
