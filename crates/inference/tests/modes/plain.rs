//! A second, plain implementation of the networks: no history, no blocks, 64-bit sums, nested
//! loops. The crate is compared with it position by position.

use inference::image::write::{LayerParts, layers};
use inference::image::{LayerKind, LayerShape, WeightForm};
use inference::{Padding, Scale};

/// Small random generator; its seed reproduces a failing case.
pub(super) struct Noise(pub(super) u64);

impl Noise {
    pub(super) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        self.0 >> 33
    }

    pub(super) fn within(&mut self, magnitude: i64) -> i64 {
        (self.bits() as i64) % (2 * magnitude + 1) - magnitude
    }

    pub(super) fn column<const IN: usize>(&mut self) -> [i16; IN] {
        core::array::from_fn(|_| self.within(32767) as i16)
    }
}

/// Parameters of a layer, in plain order.
pub(super) struct PlainLayer {
    pub(super) shape: LayerShape,
    pub(super) biases: Vec<i32>,
    pub(super) multipliers: Vec<i32>,
    pub(super) weights: Vec<i16>,
}

/// Parameters of a network, in plain order.
pub(super) struct Plain(pub(super) Vec<PlainLayer>);

impl Plain {
    /// Returns random parameters. Activations are about `gain` times full scale, and some are
    /// clipped.
    pub(super) fn random(shapes: &[LayerShape], seed: u64, gain: f64) -> Self {
        let mut noise = Noise(seed);
        Self(shapes.iter().map(|shape| PlainLayer::random(*shape, &mut noise, gain)).collect())
    }

    /// Returns the bytes of an image's layers, at an address that they can be read from.
    pub(super) fn bytes(&self) -> Vec<u32> {
        let parts: Vec<LayerParts<'_>> = self.0.iter().map(PlainLayer::parts).collect();
        let mut words = vec![0u32; self.0.iter().map(|layer| layer.shape.length()).sum::<usize>() / 4];
        let used = layers(&parts, bytemuck::cast_slice_mut(&mut words)).expect("room");
        assert_eq!(used, 4 * words.len());
        words
    }

    /// Returns the head's sums over a window (or history) of columns and the number of clipped
    /// activations.
    pub(super) fn evaluate(&self, columns: &[Vec<i64>], padding: Padding) -> (Vec<i64>, u32) {
        let (head, outputs, clipped) = self.convolutions(columns, padding);
        let newest = outputs.len() - usize::from(head.shape.columns);
        (head.sums(&outputs, newest as i64), clipped.iter().sum())
    }

    /// Returns the head's sums at every position of a history with causal zeros before it, and the
    /// number of clipped activations of that position.
    pub(super) fn stream(&self, columns: &[Vec<i64>]) -> Vec<(Vec<i64>, u32)> {
        let (head, outputs, clipped) = self.convolutions(columns, Padding::Causal);
        let oldest = |position: usize| position as i64 - i64::from(head.shape.columns) + 1;
        clipped
            .into_iter()
            .enumerate()
            .map(|(at, clipped)| (head.sums(&outputs, oldest(at)), clipped))
            .collect()
    }

    /// Returns the head, its input columns, and the number of clipped activations at each input
    /// position.
    fn convolutions(&self, columns: &[Vec<i64>], padding: Padding) -> (&PlainLayer, Vec<Vec<i64>>, Vec<u32>) {
        let (head, convolutions) = self.0.split_last().expect("a head");
        let mut clipped = vec![0; columns.len()];
        let outputs = convolutions
            .iter()
            .fold(columns.to_vec(), |columns, layer| layer.convolve(&columns, padding, &mut clipped));
        (head, outputs, clipped)
    }
}

impl PlainLayer {
    fn random(shape: LayerShape, noise: &mut Noise, gain: f64) -> Self {
        let (outputs, taps) = (usize::from(shape.outputs), shape.taps());
        let bound = (1i64 << 31) / (1 << (shape.input_bits - 1)) / taps as i64 * 9 / 10;
        let largest = match shape.form {
            WeightForm::Wide => bound.min(32_767),
            WeightForm::Packed => bound.min(127),
        };
        let size = largest as f64 / 1.7 * (taps as f64).sqrt() * f64::from(1u32 << (shape.input_bits - 2));
        let full_scale = f64::from(1u32 << (shape.output_bits.min(16) - 1));
        let factor = (gain * full_scale / size * 2f64.powi(32)).clamp(2.0, 1e9) as i64;
        let convolution = shape.kind == LayerKind::Convolution;
        Self {
            shape,
            biases: (0..outputs).map(|_| noise.within((size / 4.0).min(1e7) as i64) as i32).collect(),
            multipliers: (0..if convolution { outputs } else { 0 })
                .map(|_| (factor + noise.within(factor / 2)) as i32)
                .collect(),
            weights: (0..outputs * taps).map(|_| noise.within(largest) as i16).collect(),
        }
    }

    fn parts(&self) -> LayerParts<'_> {
        LayerParts {
            shape: self.shape,
            biases: &self.biases,
            multipliers: &self.multipliers,
            scale: Scale { multiplier: 1 << 30, shift: 40 },
            weights: &self.weights,
        }
    }

    fn sum(&self, output: usize, columns: &[Vec<i64>], oldest: i64) -> i64 {
        let inputs = usize::from(self.shape.inputs);
        let mut sum = i64::from(self.biases[output]);
        for tap in 0..usize::from(self.shape.columns) {
            let Some(column) = usize::try_from(oldest + tap as i64).ok().and_then(|at| columns.get(at))
            else {
                continue;
            };
            for (input, value) in column.iter().enumerate() {
                let weight = self.weights[output * self.shape.taps() + tap * inputs + input];
                sum += i64::from(weight) * value;
            }
        }
        sum
    }

    fn sums(&self, columns: &[Vec<i64>], oldest: i64) -> Vec<i64> {
        (0..usize::from(self.shape.outputs)).map(|output| self.sum(output, columns, oldest)).collect()
    }

    fn convolve(&self, columns: &[Vec<i64>], padding: Padding, clipped: &mut [u32]) -> Vec<Vec<i64>> {
        let kernel = usize::from(self.shape.columns);
        let before = match padding {
            Padding::Causal => kernel - 1,
            Padding::Same => (kernel - 1) / 2,
            Padding::Valid => 0,
        };
        let count = if padding == Padding::Valid { columns.len() + 1 - kernel } else { columns.len() };
        let full_scale = (1i128 << (self.shape.output_bits - 1)) - 1;
        (0..count)
            .map(|position| {
                (0..usize::from(self.shape.outputs))
                    .map(|output| {
                        let sum = self.sum(output, columns, position as i64 - before as i64);
                        let scaled = i128::from(sum) * i128::from(self.multipliers[output]);
                        let value = (scaled + (1 << 31)) >> 32;
                        clipped[position] += u32::from(value > full_scale);
                        value.clamp(0, full_scale) as i64
                    })
                    .collect()
            })
            .collect()
    }
}

/// Converts the columns of a network's type to plain columns.
pub(super) fn plain<const IN: usize>(columns: &[[i16; IN]]) -> Vec<Vec<i64>> {
    columns.iter().map(|column| column.iter().map(|&value| i64::from(value)).collect()).collect()
}
