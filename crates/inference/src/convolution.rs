//! A 1-D convolution with ReLU.

use crate::activation::Activation;
use crate::image::{ImageError, LayerKind, LayerName, LayerShape, Reader, WeightForm};
use crate::kernel::{Engine, LayerOutcome};
use crate::weights::{Around, LayerInput, WeightsOf};
use core::hash::Hasher;
use core::ops::Range;

/// Convolution over `K` columns of `IN` activations `A`, giving columns of `OUT` activations `B`.
///
/// Each output is ReLU(bias + sum of weight x input) times the multiplier of the output, rounded to
/// nearest (halves up) and clipped to the full scale of `B`.
#[derive(Clone, Copy, Debug)]
pub struct Convolution<'a, A: LayerInput, B, const IN: usize, const OUT: usize, const K: usize> {
    weights: A::Weights<'a>,
    outputs: core::marker::PhantomData<B>,
}

impl<'a, A: LayerInput, B: Activation, const IN: usize, const OUT: usize, const K: usize>
    Convolution<'a, A, B, IN, OUT, K>
{
    /// Multiply-accumulates at one position.
    pub const MACS: usize = K * IN * OUT;

    /// Returns the shape with weights in this form.
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

    /// Reads the layer from an image.
    pub(crate) fn read(reader: &mut Reader<'a>, layer: LayerName) -> Result<Self, ImageError> {
        let form = reader.shape(layer, Self::shape)?;
        Ok(Self {
            weights: A::Weights::read(reader, form, OUT, K * IN, Around::Scaling)?,
            outputs: core::marker::PhantomData,
        })
    }

    /// Hashes the addresses of the layer's parameters.
    pub(crate) fn hash_config(&self, state: &mut impl Hasher) {
        self.weights.hash_config(state);
    }

    /// Computes the outputs at one position. They are written to the first of the columns in
    /// `outputs` and, unless `N` is 0, also to the column `N` places after it. Nothing is computed
    /// if there are no such columns.
    #[inline]
    pub(crate) fn compute<E: Engine, const N: usize>(
        &self,
        columns: &[[A; IN]; K],
        outputs: &mut [[B; OUT]],
    ) -> LayerOutcome {
        self.weights.outputs::<E, B, IN, OUT, K, N>(columns, outputs)
    }

    /// Computes the outputs at one position; returns the number of clipped activations.
    #[inline]
    pub fn apply<E: Engine>(&self, columns: &[[A; IN]; K], outputs: &mut [B; OUT]) -> u32 {
        self.compute::<E, 0>(columns, core::slice::from_mut(outputs)).clipped
    }

    /// Computes the outputs at some positions of a window; returns the number of clipped
    /// activations.
    ///
    /// Output `p` depends on the inputs from `p - before` on. Columns outside the window are zero.
    /// Nothing is computed if `outputs` does not contain all positions.
    pub fn positions<E: Engine>(
        &self,
        inputs: &[[A; IN]],
        before: usize,
        positions: Range<usize>,
        outputs: &mut [[B; OUT]],
    ) -> u32 {
        let mut clipped = 0u32;
        let mut remaining = outputs.get_mut(positions.clone()).unwrap_or_default();
        let mut position = positions.start;
        while !remaining.is_empty() {
            let inside = position.checked_sub(before).and_then(|start| inputs.get(start..));
            let neighbours = inside.and_then(|columns| columns.get(..K + 1));
            let together = if remaining.len() > 1 && neighbours.is_some() { 2 } else { 1 };
            let Some((now, later)) = remaining.split_at_mut_checked(together) else { break };
            clipped = clipped.wrapping_add(match (now, neighbours, inside.and_then(<[_]>::first_chunk)) {
                ([first, second], Some(columns), _) => {
                    self.weights.pair::<E, B, IN, OUT, K>(columns, [first, second])
                }
                ([output, ..], _, Some(columns)) => self.apply::<E>(columns, output),
                ([output, ..], _, None) => self.apply::<E>(&padded(inputs, position, before), output),
                ([], ..) => 0,
            });
            (position, remaining) = (position.wrapping_add(together), later);
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

/// Returns the columns of a position at the edge, with zeros for columns outside the window.
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
