//! Dense output layer: raw sums.

use crate::image::{ImageError, LayerKind, LayerName, LayerShape, Reader, WeightForm};
use crate::kernel::Engine;
use crate::scale::Scale;
use crate::weights::{Around, LayerInput, WeightsOf, hash_place};
use core::hash::{Hash, Hasher};

/// Dense layer over `COLUMNS` columns of `IN` activations, oldest first. Its `OUT` sums are not
/// requantised.
#[derive(Clone, Copy, Debug)]
pub struct Head<'a, A: LayerInput, const IN: usize, const COLUMNS: usize, const OUT: usize> {
    scale: Scale,
    biases: &'a [i32; OUT],
    weights: A::Weights<'a>,
}

impl<'a, A: LayerInput, const IN: usize, const COLUMNS: usize, const OUT: usize>
    Head<'a, A, IN, COLUMNS, OUT>
{
    /// Multiply-accumulates.
    pub const MACS: usize = COLUMNS * IN * OUT;

    /// Hashes the scale and the addresses of the layer's parameters.
    pub(crate) fn hash_config(&self, state: &mut impl Hasher) {
        self.scale.hash(state);
        hash_place(self.biases, state);
        self.weights.hash_config(state);
    }

    /// Returns the shape with weights in this form.
    pub const fn shape(form: WeightForm) -> LayerShape {
        const {
            assert!(COLUMNS > 0 && COLUMNS <= u8::MAX as usize && IN > 0 && IN <= u16::MAX as usize);
            assert!(OUT > 0 && OUT <= u16::MAX as usize);
        }
        LayerShape {
            kind: LayerKind::Head,
            columns: COLUMNS as u8,
            inputs: IN as u16,
            outputs: OUT as u16,
            input_bits: A::BITS,
            output_bits: 32,
            form,
        }
    }

    /// Reads the layer from an image.
    pub(crate) fn read(reader: &mut Reader<'a>, layer: LayerName) -> Result<Self, ImageError> {
        let form = reader.shape(layer, Self::shape)?;
        Ok(Self {
            scale: Scale { multiplier: reader.u32()?.cast_signed(), shift: reader.u32()? },
            biases: reader.array()?,
            weights: A::Weights::read(reader, form, OUT, COLUMNS * IN, Around::Nothing)?,
        })
    }

    /// Computes the raw sums.
    #[inline]
    pub fn apply<E: Engine>(&self, columns: &[[A; IN]; COLUMNS]) -> [i32; OUT] {
        let mut sums = *self.biases;
        self.weights.sums::<E, IN, OUT, COLUMNS>(columns, &mut sums);
        sums
    }

    /// Scale of the sums.
    pub fn scale(&self) -> Scale {
        self.scale
    }

    /// Bias of an output.
    pub fn bias(&self, output: usize) -> Option<i32> {
        self.biases.get(output).copied()
    }

    /// Weight of an output at a tap; taps count column by column, oldest first.
    pub fn weight(&self, output: usize, tap: usize) -> Option<i32> {
        if output < OUT && tap < COLUMNS * IN {
            self.weights.weight(output, tap, COLUMNS * IN, Around::Nothing)
        } else {
            None
        }
    }
}
