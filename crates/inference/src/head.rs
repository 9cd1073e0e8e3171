//! Dense output layer: raw sums and their scale.

use crate::activation::Activation;
use crate::error::ImageError;
use crate::image::{LayerKind, LayerName, LayerShape, Reader, WeightForm};
use crate::kernel::Engine;
use crate::weights::{Around, WeightsOf, hash_place};
use core::hash::{Hash, Hasher};

/// Dense layer over `COLUMNS` columns of `IN` activations, oldest first. Its `OUT` sums are not
/// requantised.
#[derive(Clone, Copy, Debug)]
pub struct Head<'a, A: Activation, const IN: usize, const COLUMNS: usize, const OUT: usize> {
    scale: Scale,
    biases: &'a [i32; OUT],
    weights: A::Weights<'a>,
}

/// Value of one count of a head's sum: `multiplier / 2^shift`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Scale {
    /// Multiplier above 0, with full precision from 2^30 on.
    pub multiplier: i32,
    /// Power of two to divide by: 25 to 78.
    pub shift: u32,
}

impl Scale {
    /// Returns a sum in the scale's unit, times 2^`fraction_bits` (15 to 25), rounded down; 0 for a
    /// negative sum, at most `u32::MAX`.
    #[inline]
    pub fn apply(self, sum: i32, fraction_bits: u32) -> u32 {
        let product = (sum.max(0) as u32 as u64).wrapping_mul(self.multiplier as u32 as u64);
        // The loader has checked that the shift stays within 0..=63.
        let value = product >> (self.shift.wrapping_sub(fraction_bits) & 63);
        value.min(u64::from(u32::MAX)) as u32
    }

    /// Returns the scale as a floating-point number, for reports.
    pub fn to_f64(self) -> f64 {
        f64::from(self.multiplier) / libm::exp2(f64::from(self.shift))
    }
}

impl<'a, A: Activation, const IN: usize, const COLUMNS: usize, const OUT: usize>
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scale_multiplies_rounds_down_and_saturates() {
        let scale = Scale { multiplier: 3 << 29, shift: 45 };
        assert!((scale.to_f64() - 1.5 / 32768.0).abs() < 1e-18);
        assert_eq!(scale.apply(32768, 16), 3 << 15);
        assert_eq!(scale.apply(-5, 16), 0);
        assert_eq!(Scale { multiplier: i32::MAX, shift: 25 }.apply(i32::MAX, 24), u32::MAX);
    }
}
