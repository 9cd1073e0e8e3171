//! The two kinds of layer and their kernels, reading weights in place.
//!
//! Activations are i16 (after ReLU 0..=32767), weights i8 per output channel, accumulators i32. An accumulator
//! cannot overflow: [`Convolution::read`] and [`Head::read`] add up `|w|` and refuse a layer where
//! `sum |w| * 32768 + |bias|` reaches 2^31. So the wrapping operations below never wrap; they keep a build with checked
//! arithmetic free of panics. The instruction count does not depend on the data.

use crate::error::{ImageError, LayerName};
use crate::layout::{BLOCK, BLOCKS, CHANNELS, HEAD_COLUMNS, HEAD_WEIGHTS};
use crate::read::Reader;

/// Largest magnitude of an activation.
const ACTIVATION_MAGNITUDE: i64 = 32768;

/// Largest magnitude that an accumulator can reach, with one more weight.
fn with_weight(largest: i64, byte: u8) -> i64 {
    largest.saturating_add(i64::from(weight(byte)).abs().saturating_mul(ACTIVATION_MAGNITUDE))
}

fn check(layer: LayerName, largest_accumulator: i64) -> Result<(), ImageError> {
    if largest_accumulator > i64::from(i32::MAX) {
        return Err(ImageError::Layer { layer, largest_accumulator });
    }
    Ok(())
}

fn weight(byte: u8) -> i32 {
    i32::from(byte as i8)
}

/// A causal convolution: `TAPS` = 3 columns of inputs, oldest first, to 16 channels, with ReLU.
#[derive(Clone, Copy, Debug)]
pub struct Convolution<'a, const TAPS: usize> {
    biases: &'a [[[u8; 4]; BLOCK]; BLOCKS],
    multipliers: &'a [[[u8; 4]; BLOCK]; BLOCKS],
    weights: &'a [[[u8; BLOCK]; TAPS]; BLOCKS],
}

impl<'a, const TAPS: usize> Convolution<'a, TAPS> {
    /// Takes the layer from an image and proves its accumulators.
    pub(crate) fn read(reader: &mut Reader<'a>, layer: LayerName) -> Result<Self, ImageError> {
        let layer_read =
            Self { biases: reader.blocks()?, multipliers: reader.blocks()?, weights: reader.blocks()? };
        for ((weights, biases), multipliers) in
            layer_read.weights.iter().zip(layer_read.biases).zip(layer_read.multipliers)
        {
            let mut largest = biases.map(|bias| i64::from(i32::from_le_bytes(bias)).abs());
            for tap in weights {
                for (largest, &byte) in largest.iter_mut().zip(tap) {
                    *largest = with_weight(*largest, byte);
                }
            }
            for (&largest, &multiplier) in largest.iter().zip(multipliers) {
                check(layer, largest)?;
                if i32::from_le_bytes(multiplier) <= 0 {
                    return Err(ImageError::Layer { layer, largest_accumulator: 0 });
                }
            }
        }
        Ok(layer_read)
    }

    /// Computes one column of outputs and returns how many of them were clipped.
    #[inline]
    pub fn apply(&self, inputs: &[i16; TAPS], outputs: &mut [i16; CHANNELS]) -> u16 {
        const { assert!(TAPS.is_multiple_of(2)) };
        let mut clipped = 0u16;
        let (outputs, _) = outputs.as_chunks_mut::<BLOCK>();
        for (((weights, biases), multipliers), outputs) in
            self.weights.iter().zip(self.biases).zip(self.multipliers).zip(outputs)
        {
            let mut accumulators = biases.map(i32::from_le_bytes);
            // Two taps a turn. The length is hidden from the compiler, which otherwise unrolls until its registers
            // spill (3.5 instead of 3.9 instructions a product on a Cortex-M4); the result is the same either way.
            let taps: &[[[u8; BLOCK]; 2]] = core::hint::black_box(weights.as_chunks::<2>().0);
            for (taps, inputs) in taps.iter().zip(inputs.as_chunks::<2>().0) {
                for (tap, &input) in taps.iter().zip(inputs) {
                    let input = i32::from(input);
                    for (accumulator, &byte) in accumulators.iter_mut().zip(tap) {
                        *accumulator = accumulator.wrapping_add(weight(byte).wrapping_mul(input));
                    }
                }
            }
            for ((output, accumulator), &multiplier) in outputs.iter_mut().zip(accumulators).zip(multipliers)
            {
                let value = requantise(accumulator, i32::from_le_bytes(multiplier));
                clipped = clipped.wrapping_add(u16::from(value > i32::from(i16::MAX)));
                *output = value.min(i32::from(i16::MAX)) as i16;
            }
        }
        clipped
    }

    /// Bias of an output channel.
    pub(crate) fn bias(&self, output: usize) -> Option<i32> {
        self.biases.as_flattened().get(output).map(|bytes| i32::from_le_bytes(*bytes))
    }

    /// Multiplier of an output channel.
    pub(crate) fn multiplier(&self, output: usize) -> Option<i32> {
        self.multipliers.as_flattened().get(output).map(|bytes| i32::from_le_bytes(*bytes))
    }

    /// Weight of an output channel at a tap.
    pub(crate) fn weight(&self, output: usize, tap: usize) -> Option<i32> {
        let block = self.weights.get(output / BLOCK)?;
        block.get(tap)?.get(output % BLOCK).map(|&byte| weight(byte))
    }
}

/// ReLU, then times `multiplier / 2^32`, rounded to nearest, halves up.
#[inline]
pub(crate) fn requantise(accumulator: i32, multiplier: i32) -> i32 {
    let wide = i64::from(accumulator.max(0)).wrapping_mul(i64::from(multiplier));
    (wide.wrapping_add(1 << 31) >> 32) as i32
}

/// The dense head: two columns of 16 channels, oldest first, to one raw accumulator.
#[derive(Clone, Copy, Debug)]
pub struct Head<'a> {
    scale: f32,
    bias: i32,
    weights: &'a [u8; HEAD_WEIGHTS],
}

impl<'a> Head<'a> {
    /// Takes the head from an image and proves its accumulator.
    pub(crate) fn read(reader: &mut Reader<'a>, layer: LayerName) -> Result<Self, ImageError> {
        let head = Self { scale: reader.f32()?, bias: reader.i32()?, weights: reader.chunk()? };
        let bias = i64::from(head.bias).abs();
        check(layer, head.weights.iter().fold(bias, |largest, &byte| with_weight(largest, byte)))?;
        if !(head.scale.is_finite() && head.scale > 0.0) {
            return Err(ImageError::Layer { layer, largest_accumulator: 0 });
        }
        Ok(head)
    }

    /// The raw accumulator.
    #[inline]
    pub fn apply(&self, columns: &[[i16; CHANNELS]; HEAD_COLUMNS]) -> i32 {
        columns.as_flattened().iter().zip(self.weights).fold(self.bias, |sum, (&input, &byte)| {
            sum.wrapping_add(weight(byte).wrapping_mul(i32::from(input)))
        })
    }

    /// What one count of the accumulator is worth.
    pub fn scale(&self) -> f32 {
        self.scale
    }

    /// Bias of the accumulator.
    pub(crate) fn bias(&self) -> i32 {
        self.bias
    }

    /// Weight at a position of the flattened columns.
    pub(crate) fn weight(&self, position: usize) -> Option<i32> {
        self.weights.get(position).map(|&byte| weight(byte))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn requantise_rounds_to_nearest(accumulator in any::<i32>(), multiplier in 1..i32::MAX) {
            let exact = f64::from(accumulator.max(0)) * f64::from(multiplier) / 4_294_967_296.0;
            prop_assert!((f64::from(requantise(accumulator, multiplier)) - exact).abs() <= 0.5);
        }
    }
}
