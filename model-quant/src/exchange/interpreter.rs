//! Interpreter of encoded layers with the arithmetic of the engine, for any shape.
//!
//! The engine's networks have shapes fixed at compile time; here the shapes are read from the
//! bytes. It is slower and gives the same bits. Weights are decoded from their packed form, so that
//! the written bytes are what is evaluated. Tests compare it with the engine.

use crate::network::Padding;
use inference::image::{LayerKind, LayerShape, SHAPE_LENGTH, WeightForm};
use inference::kernel::{BLOCK, Engine, Portable};
use inference::storage::{Packed8, Packed16, Storage, Wide};
use inference::{ImageError, Scale};

/// One decoded layer.
#[derive(Clone, Debug)]
struct Layer {
    shape: LayerShape,
    biases: Vec<i32>,
    multipliers: Vec<i32>,
    scale: Scale,
    /// Ordered by output, then tap.
    weights: Vec<i32>,
}

/// Fixed-point network in evaluable form.
#[derive(Clone, Debug)]
pub struct Interpreter {
    padding: Padding,
    layers: Vec<Layer>,
}

/// Result of a window.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sums {
    /// Sums of the head.
    pub sums: Vec<i32>,
    /// Number of activations that were clipped at full scale.
    pub clipped: usize,
}

impl Interpreter {
    /// Decodes layers, as [`inference::image::write::layers`] writes them.
    ///
    /// # Errors
    ///
    /// The bytes are not a sequence of layers.
    pub fn new(bytes: &[u8], padding: Padding) -> Result<Self, ImageError> {
        let mut layers = Vec::new();
        let mut remaining = bytes;
        while !remaining.is_empty() {
            let (layer, later) = Layer::read(remaining).ok_or(ImageError::TooShort)?;
            layers.push(layer);
            remaining = later;
        }
        Ok(Self { padding, layers })
    }

    /// Value of one count of the head's sums.
    pub fn scale(&self) -> f64 {
        self.layers.last().map_or(0.0, |head| head.scale.to_f64())
    }

    /// Evaluates a window: columns oldest first, flattened.
    pub fn run(&self, window: &[i16]) -> Sums {
        let mut values: Vec<i32> = window.iter().map(|&value| i32::from(value)).collect();
        let mut clipped = 0;
        for layer in &self.layers {
            values = layer.run(&values, self.padding, &mut clipped);
        }
        Sums { sums: values, clipped }
    }
}

impl Layer {
    fn read(bytes: &[u8]) -> Option<(Self, &[u8])> {
        let (head, _) = bytes.split_first_chunk::<SHAPE_LENGTH>()?;
        let shape = LayerShape::from_bytes(head)?;
        let (layer, remaining) = bytes.split_at_checked(shape.length())?;
        let words: Vec<u32> =
            layer.get(SHAPE_LENGTH..)?.as_chunks::<4>().0.iter().map(|w| u32::from_le_bytes(*w)).collect();
        let outputs = usize::from(shape.outputs);
        let no_scale = Scale { multiplier: 0, shift: 0 };
        let (scale, biases, words) = match shape.kind {
            LayerKind::Convolution => (no_scale, &[][..], &words[..]),
            LayerKind::Head => {
                let (&[multiplier, shift], remaining) = words.split_first_chunk()?;
                let (biases, remaining) = remaining.split_at_checked(outputs)?;
                (Scale { multiplier: multiplier.cast_signed(), shift }, biases, remaining)
            }
        };
        let mut biases: Vec<i32> = biases.iter().map(|bias| bias.cast_signed()).collect();
        let (mut multipliers, mut weights) = (Vec::new(), Vec::new());
        for row in rows(words, outputs)? {
            let groups = match (shape.kind, &row[..]) {
                (LayerKind::Convolution, [bias, groups @ .., multiplier]) => {
                    biases.push(bias.cast_signed());
                    multipliers.push(multiplier.cast_signed());
                    groups
                }
                (_, groups) => groups,
            };
            weights.extend(match (shape.form, shape.input_bits) {
                (WeightForm::Wide, _) => unpacked::<Wide>(groups, shape.taps()),
                (WeightForm::Packed, 8) => unpacked::<Packed8>(groups, shape.taps()),
                (WeightForm::Packed, _) => unpacked::<Packed16>(groups, shape.taps()),
            }?);
        }
        Some((Self { shape, biases, multipliers, scale, weights }, remaining))
    }

    fn run(&self, inputs: &[i32], padding: Padding, clipped: &mut usize) -> Vec<i32> {
        let (width, kernel) = (usize::from(self.shape.inputs), usize::from(self.shape.columns));
        let columns = inputs.len() / width;
        let is_head = self.shape.kind == LayerKind::Head;
        let (before, positions) = match padding {
            _ if is_head => (0, usize::from(columns >= kernel)),
            Padding::Valid => (0, (columns + 1).saturating_sub(kernel)),
            Padding::Same => ((kernel - 1) / 2, columns),
        };
        // A head uses the newest columns.
        let start = if is_head { columns.saturating_sub(kernel) } else { 0 };
        let full_scale = (1 << (self.shape.output_bits.min(31) - 1)) - 1;
        let mut outputs = Vec::with_capacity(positions * self.biases.len());
        for position in 0..positions {
            let value = |tap: usize| {
                let column = (start + position + tap / width).checked_sub(before);
                let place = column.map(|column| column * width + tap % width);
                place.and_then(|place| inputs.get(place)).copied().unwrap_or(0)
            };
            let rows = self.weights.chunks_exact(self.shape.taps());
            for (output, (row, bias)) in rows.zip(&self.biases).enumerate() {
                let products = row.iter().enumerate().map(|(tap, weight)| weight.wrapping_mul(value(tap)));
                let sum = products.fold(*bias, i32::wrapping_add);
                outputs.push(match self.multipliers.get(output) {
                    Some(&multiplier) => {
                        let scaled = Portable::requantise(sum, multiplier);
                        *clipped += usize::from(scaled > full_scale);
                        scaled.clamp(0, full_scale)
                    }
                    None => sum,
                });
            }
        }
        outputs
    }
}

/// Words of each output. Complete blocks of outputs are interleaved; the remaining outputs are
/// contiguous.
fn rows(words: &[u32], outputs: usize) -> Option<Vec<Vec<u32>>> {
    let (complete_blocks, per_output) = (outputs / BLOCK * BLOCK, words.len() / outputs);
    let place = |output: usize, index: usize| {
        if output < complete_blocks {
            (output / BLOCK * per_output + index) * BLOCK + output % BLOCK
        } else {
            output * per_output + index
        }
    };
    let row = |output| (0..per_output).map(|index| words.get(place(output, index)).copied()).collect();
    (0..outputs).map(row).collect()
}

/// Decodes the weights of an output.
fn unpacked<S: Storage>(groups: &[u32], taps: usize) -> Option<Vec<i32>> {
    let weight = |tap: usize| Some(S::weight(*groups.get(tap / S::TAPS)?, tap % S::TAPS));
    (0..taps).map(weight).collect()
}
