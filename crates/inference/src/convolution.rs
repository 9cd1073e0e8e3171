//! A 1-D convolution with ReLU.

use crate::activation::Activation;
use crate::error::ImageError;
use crate::image::{LayerKind, LayerName, LayerShape, Reader, WeightForm};
use crate::kernel::{BLOCK, Engine, requantise};
use crate::weights::WeightsOf;
use core::ops::Range;

/// A convolution over columns of `IN` activations `A` to columns of `OUT` activations `B`, looking at `K` columns.
///
/// Output = ReLU(bias + sum weight x input) times a factor of its own, rounded to nearest (halves up) and clipped to the
/// full scale of `B`.
#[derive(Clone, Copy, Debug)]
pub struct Convolution<'a, A: Activation, B, const IN: usize, const OUT: usize, const K: usize> {
    biases: &'a [i32; OUT],
    multipliers: &'a [i32; OUT],
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
            biases: reader.array()?,
            multipliers: reader.array()?,
            weights: A::Weights::read(reader, layer, form, OUT, K * IN)?,
            outputs: core::marker::PhantomData,
        })
    }

    /// Scales a sum and puts it in its place; gives 1 if it had to be clipped at full scale.
    #[inline]
    fn put(&self, output: usize, sum: i32, column: &mut [B; OUT]) -> u32 {
        let multiplier = self.multipliers.get(output).copied().unwrap_or_default();
        let value = requantise(sum, multiplier);
        if let Some(slot) = column.get_mut(output) {
            *slot = B::clip(value);
        }
        u32::from(value > B::MAX)
    }

    /// Sums of a block before its first product: the biases.
    #[inline]
    fn start(&self, block: usize) -> [i32; BLOCK] {
        self.biases.as_chunks::<BLOCK>().0.get(block).copied().unwrap_or_default()
    }

    /// Scales and stores the sums of a block; gives how many were clipped.
    #[inline]
    fn finish(&self, block: usize, sums: [i32; BLOCK], column: &mut [B; OUT]) -> u32 {
        let multipliers = self.multipliers.as_chunks::<BLOCK>().0.get(block);
        let outputs = column.as_chunks_mut::<BLOCK>().0.get_mut(block);
        let (Some(multipliers), Some(outputs)) = (multipliers, outputs) else { return 0 };
        let mut clipped = 0u32;
        for ((slot, sum), &multiplier) in outputs.iter_mut().zip(sums).zip(multipliers) {
            let value = requantise(sum, multiplier);
            clipped = clipped.wrapping_add(u32::from(value > B::MAX));
            *slot = B::clip(value);
        }
        clipped
    }

    /// Computes some units of the outputs at one position; gives how many activations were clipped.
    #[inline]
    pub fn units<E: Engine>(&self, units: Range<usize>, columns: &[[A; IN]; K], outputs: &mut [B; OUT]) -> u32 {
        let mut clipped = 0u32;
        for unit in units {
            if unit < OUT / BLOCK {
                let mut sums = self.start(unit);
                self.weights.block::<E, IN, K>(unit, columns, &mut sums);
                clipped = clipped.wrapping_add(self.finish(unit, sums, outputs));
            } else {
                for left in 0..OUT % BLOCK {
                    let output = (OUT - OUT % BLOCK).wrapping_add(left);
                    let bias = self.biases.get(output).copied().unwrap_or_default();
                    let sum = self.weights.row::<E, IN, K>(left, columns, bias);
                    clipped = clipped.wrapping_add(self.put(output, sum, outputs));
                }
            }
        }
        clipped
    }

    /// Computes the outputs at one position; gives how many were clipped.
    #[inline]
    pub fn apply<E: Engine>(&self, columns: &[[A; IN]; K], outputs: &mut [B; OUT]) -> u32 {
        self.units::<E>(0..Self::UNITS, columns, outputs)
    }

    /// Computes the outputs at two neighbouring positions from `K + 1` columns; gives how many were clipped.
    #[inline]
    fn apply_pair<E: Engine>(&self, columns: &[[A; IN]], [first, second]: [&mut [B; OUT]; 2]) -> u32 {
        let mut clipped = 0u32;
        for block in 0..OUT / BLOCK {
            let mut sums = [self.start(block); 2];
            self.weights.pair::<E, IN, K>(block, columns, &mut sums);
            let [at_first, at_second] = sums;
            clipped = clipped.wrapping_add(self.finish(block, at_first, first));
            clipped = clipped.wrapping_add(self.finish(block, at_second, second));
        }
        if !OUT.is_multiple_of(BLOCK)
            && let (Some(at_first), Some(at_second)) = (columns.first_chunk(), columns.last_chunk())
        {
            clipped = clipped.wrapping_add(self.units::<E>(OUT / BLOCK..Self::UNITS, at_first, first));
            clipped = clipped.wrapping_add(self.units::<E>(OUT / BLOCK..Self::UNITS, at_second, second));
        }
        clipped
    }

    /// Computes the outputs at some positions of a window; output `p` looks at the inputs from `p - before` on, and what
    /// lies outside the window is zero. Gives how many activations were clipped.
    ///
    /// Positions that are not in `outputs` are left out.
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
                ([first, second], Some(columns), _) => self.apply_pair::<E>(columns, [first, second]),
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
        self.biases.get(output).copied()
    }

    /// Multiplier of an output: the real factor times 2^32.
    pub fn multiplier(&self, output: usize) -> Option<i32> {
        self.multipliers.get(output).copied()
    }

    /// Weight of an output at a tap; taps count column by column, oldest first.
    pub fn weight(&self, output: usize, tap: usize) -> Option<i32> {
        self.weights.weight(output, tap)
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
