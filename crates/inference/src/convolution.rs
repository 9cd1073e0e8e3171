//! A 1-D convolution with ReLU.

use crate::activation::Activation;
use crate::error::ImageError;
use crate::image::{LayerKind, LayerName, LayerShape, Reader, WeightForm};
use crate::kernel::{BLOCK, Done, Engine};
use crate::weights::{Around, WeightsOf};
use core::hash::Hasher;
use core::ops::Range;

/// A convolution over columns of `IN` activations `A` to columns of `OUT` activations `B`, looking at `K` columns.
///
/// Output = ReLU(bias + sum weight x input) times a factor of its own, rounded to nearest (halves up) and clipped to the
/// full scale of `B`.
#[derive(Clone, Copy, Debug)]
pub struct Convolution<'a, A: Activation, B, const IN: usize, const OUT: usize, const K: usize> {
    weights: A::Weights<'a>,
    outputs: core::marker::PhantomData<B>,
}

impl<'a, A: Activation, B: Activation, const IN: usize, const OUT: usize, const K: usize>
    Convolution<'a, A, B, IN, OUT, K>
{
    /// Units of work at one position: whole blocks of outputs, and what is left over.
    pub const UNITS: usize = OUT.div_ceil(BLOCK);
    /// Multiply-accumulates at one position.
    pub const MACS: usize = K * IN * OUT;

    /// The shape with weights in this form.
    pub const fn shape(form: WeightForm) -> LayerShape {
        const {
            assert!(K > 0 && K <= u8::MAX as usize && IN > 0 && IN <= u16::MAX as usize);
            assert!(OUT > 0 && OUT <= u16::MAX as usize);
        }
        LayerShape {
            kind: LayerKind::Convolution,
            columns: K as u8,
            inputs: IN as u16,
            outputs: OUT as u16,
            input_bits: A::BITS,
            output_bits: B::BITS,
            form,
        }
    }

    /// Takes the layer from an image.
    pub(crate) fn read(reader: &mut Reader<'a>, layer: LayerName) -> Result<Self, ImageError> {
        let form = reader.shape(layer, Self::shape)?;
        Ok(Self {
            weights: A::Weights::read(reader, form, OUT, K * IN, Around::Scaling)?,
            outputs: core::marker::PhantomData,
        })
    }

    /// Where its numbers lie.
    pub(crate) fn constants(&self, sum: &mut impl Hasher) {
        self.weights.constants(sum);
    }

    /// Computes some units of the outputs at one position, written to the first of the columns in `outputs` and, unless `N` is 0, to the one
    /// `N` behind it as well. Nothing is computed where there are no such columns.
    #[inline]
    pub fn units<E: Engine, const N: usize>(
        &self,
        units: Range<usize>,
        columns: &[[A; IN]; K],
        outputs: &mut [[B; OUT]],
    ) -> Done {
        self.weights.units::<E, B, IN, OUT, K, N>(units, columns, outputs)
    }

    /// Computes the outputs at one position; gives how many were clipped. (Whether the way through the layer's numbers went astray only streams tell.)
    #[inline]
    pub fn apply<E: Engine>(&self, columns: &[[A; IN]; K], outputs: &mut [B; OUT]) -> u32 {
        let Done { clipped, .. } =
            self.units::<E, 0>(0..Self::UNITS, columns, core::slice::from_mut(outputs));
        clipped
    }

    /// Computes the outputs at some positions of a window; output `p` looks at the inputs from `p - before` on, and what
    /// lies outside the window is zero. Gives how many activations were clipped.
    ///
    /// Nothing is computed if not all of the positions are in `outputs`.
    pub fn positions<E: Engine>(
        &self,
        inputs: &[[A; IN]],
        before: usize,
        positions: Range<usize>,
        outputs: &mut [[B; OUT]],
    ) -> u32 {
        let mut clipped = 0u32;
        let mut rest = outputs.get_mut(positions.clone()).unwrap_or_default();
        let mut position = positions.start;
        while !rest.is_empty() {
            let inside = position.checked_sub(before).and_then(|start| inputs.get(start..));
            let neighbours = inside.and_then(|columns| columns.get(..K + 1));
            let together = if rest.len() > 1 && neighbours.is_some() { 2 } else { 1 };
            let Some((now, behind)) = rest.split_at_mut_checked(together) else { break };
            clipped = clipped.wrapping_add(match (now, neighbours, inside.and_then(<[_]>::first_chunk)) {
                ([first, second], Some(columns), _) => {
                    self.weights.pair::<E, B, IN, OUT, K>(columns, [first, second])
                }
                ([output, ..], _, Some(columns)) => self.apply::<E>(columns, output),
                ([output, ..], _, None) => self.apply::<E>(&padded(inputs, position, before), output),
                ([], ..) => 0,
            });
            (position, rest) = (position.wrapping_add(together), behind);
        }
        clipped
    }

    /// Bias of an output.
    pub fn bias(&self, output: usize) -> Option<i32> {
        self.around(output).map(|[bias, _]| bias)
    }

    /// Multiplier of an output: the real factor times 2^32.
    pub fn multiplier(&self, output: usize) -> Option<i32> {
        self.around(output).map(|[_, multiplier]| multiplier)
    }

    /// Weight of an output at a tap; taps count column by column, oldest first.
    pub fn weight(&self, output: usize, tap: usize) -> Option<i32> {
        if output < OUT && tap < K * IN {
            self.weights.weight(output, tap, K * IN, Around::Scaling)
        } else {
            None
        }
    }

    fn around(&self, output: usize) -> Option<[i32; 2]> {
        if output < OUT { self.weights.around(output, K * IN) } else { None }
    }
}

/// The columns that a position at the edge looks at, with zeros for those outside.
fn padded<A: Activation, const IN: usize, const K: usize>(
    inputs: &[[A; IN]],
    position: usize,
    before: usize,
) -> [[A; IN]; K] {
    let mut columns = [[A::default(); IN]; K];
    for (tap, column) in columns.iter_mut().enumerate() {
        let source = position.wrapping_add(tap).checked_sub(before);
        if let Some(input) = source.and_then(|source| inputs.get(source)) {
            *column = *input;
        }
    }
    columns
}
