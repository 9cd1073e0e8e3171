//! Float networks: shape, weights, evaluation of a window, recipe and checkpoint.
//!
//! Weights are ordered by tap (oldest column first, then input) and then by output. Evaluation uses
//! only `+` and `*` in the order of the taps, starting with the bias, so the result has the same
//! bits on every machine with IEEE 754 arithmetic. Training uses separate, faster kernels
//! (`train`).

pub mod checkpoint;
pub mod float_pair;
mod kind;
pub mod recipe;
mod shape;
pub mod shipped;

pub(crate) use kind::LAYERS;
pub use kind::NetworkKind;
pub use shape::{ConvolutionShape, LayerSize, MAX_SIZE, Padding, Shape, ShapeError};

use crate::data::draw::Draw;

/// Number of outputs that are summed together.
const BLOCK: usize = 16;

/// Weights and biases of one layer.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Ordered by tap (oldest column first, then input), then output.
    pub weights: Vec<f32>,
    /// Ordered by output.
    pub biases: Vec<f32>,
}

impl Layer {
    fn zero(size: &LayerSize) -> Self {
        Self { weights: vec![0.0; size.weights()], biases: vec![0.0; size.outputs] }
    }

    /// Computes the sums of all outputs at one position.
    pub(crate) fn sums(&self, inputs: &[f32], sums: &mut [f32]) {
        let outputs = self.biases.len();
        let (blocks, tail) = sums.as_chunks_mut::<BLOCK>();
        let (biases, biases_left) = self.biases.as_chunks::<BLOCK>();
        for (block, (sums, biases)) in blocks.iter_mut().zip(biases).enumerate() {
            let mut found = *biases;
            for (x, row) in inputs.iter().zip(self.weights.chunks_exact(outputs)) {
                let Some(row) = row.get(block * BLOCK..).and_then(<[f32]>::first_chunk::<BLOCK>) else {
                    break;
                };
                for (sum, w) in found.iter_mut().zip(row) {
                    *sum += x * w;
                }
            }
            *sums = found;
        }
        let done = outputs - biases_left.len();
        for (output, (sum, bias)) in tail.iter_mut().zip(biases_left).enumerate() {
            let column = self.weights.iter().skip(done + output).step_by(outputs);
            *sum = inputs.iter().zip(column).fold(*bias, |sum, (x, w)| sum + x * w);
        }
    }
}

/// A network: convolutions and a dense head.
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    shape: Shape,
    layers: Vec<Layer>,
}

impl Network {
    /// Creates a network from its parameters.
    ///
    /// # Errors
    ///
    /// The shape is invalid, or the number of parameters differs from the shape.
    pub fn new(shape: Shape, layers: Vec<Layer>) -> Result<Self, ShapeError> {
        shape.check()?;
        let sizes = shape.layers();
        let wrong =
            |layer, what, found, expected| Err(ShapeError::Parameters { layer, what, found, expected });
        if layers.len() != sizes.len() {
            return wrong(layers.len(), "layers", layers.len(), sizes.len());
        }
        for (index, (layer, size)) in layers.iter().zip(&sizes).enumerate() {
            if layer.weights.len() != size.weights() {
                return wrong(index, "weights", layer.weights.len(), size.weights());
            }
            if layer.biases.len() != size.outputs {
                return wrong(index, "biases", layer.biases.len(), size.outputs);
            }
        }
        Ok(Self { shape, layers })
    }

    /// Creates a network with all parameters 0.
    pub(crate) fn zero(shape: Shape) -> Self {
        let layers = shape.layers().iter().map(Layer::zero).collect();
        Self { shape, layers }
    }

    /// Creates a network with random weights. With [`Padding::Same`] all weights have He's
    /// variance. With [`Padding::Valid`] those of the newest column do, and those of older columns
    /// have a tenth of its standard deviation: the laws depend on the newest column alone.
    pub fn start(shape: Shape, draw: &mut Draw) -> Self {
        let mut network = Self::zero(shape);
        let sizes = network.shape.layers();
        let newest_first = network.shape.padding == Padding::Valid;
        let Some((head, convolutions)) = network.layers.split_last_mut() else { return network };
        for (layer, size) in convolutions.iter_mut().zip(&sizes) {
            let (seen, older) =
                if newest_first { (size.inputs, size.taps() - size.inputs) } else { (size.taps(), 0) };
            let deviation = libm::sqrt(2.0 / seen as f64);
            for (tap, row) in layer.weights.chunks_exact_mut(size.outputs).enumerate() {
                let shrink = if tap < older { 0.1 } else { 1.0 };
                row.fill_with(|| (deviation * shrink * draw.normal()) as f32);
            }
        }
        if let Some(first) = convolutions.first_mut() {
            first.biases.fill_with(|| (0.3 * draw.normal()) as f32);
        }
        if let Some(size) = sizes.last() {
            let seen = if newest_first { size.inputs } else { size.taps() };
            let deviation = libm::sqrt(1.0 / seen as f64);
            for weight in head.weights.iter_mut().rev().take(seen * size.outputs) {
                *weight = (deviation * draw.normal()) as f32;
            }
        }
        network
    }

    /// Shape of the network.
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// Layers, the head last.
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// All parameters: layer by layer, weights before biases.
    pub fn parameters(&self) -> impl Iterator<Item = f32> + '_ {
        self.slices().flatten().copied()
    }

    /// Parameters as slices: weights, then biases, of every layer.
    pub(crate) fn slices(&self) -> impl Iterator<Item = &[f32]> {
        self.layers.iter().flat_map(|layer| [layer.weights.as_slice(), layer.biases.as_slice()])
    }

    /// Mutable form of [`Network::slices`].
    pub(crate) fn slices_mut(&mut self) -> impl Iterator<Item = &mut [f32]> {
        self.layers.iter_mut().flat_map(|layer| [layer.weights.as_mut_slice(), layer.biases.as_mut_slice()])
    }

    /// Evaluates a window: columns oldest first, flattened. Missing values count as 0.
    pub fn evaluate(&self, window: &[f32]) -> Vec<f32> {
        self.activations(window).pop().unwrap_or_default()
    }

    /// Evaluates a window and returns the outputs of every layer, the head last.
    pub(crate) fn activations(&self, window: &[f32]) -> Vec<Vec<f32>> {
        let mut found: Vec<Vec<f32>> = Vec::with_capacity(self.layers.len());
        for (layer, size) in self.layers.iter().zip(self.shape.layers()) {
            let inputs = found.last().map_or(window, Vec::as_slice);
            let mut padded = vec![0.0; (size.positions + size.kernel - 1) * size.inputs];
            for (slot, value) in padded.iter_mut().skip(size.before * size.inputs).zip(inputs) {
                *slot = *value;
            }
            let mut outputs = vec![0.0; size.positions * size.outputs];
            let windows = padded.windows(size.taps()).step_by(size.inputs);
            for (taps, sums) in windows.zip(outputs.chunks_exact_mut(size.outputs)) {
                layer.sums(taps, sums);
            }
            if found.len() + 1 < self.layers.len() {
                rectify(&mut outputs);
            }
            found.push(outputs);
        }
        found
    }
}

/// Applies ReLU in place.
pub(crate) fn rectify(values: &mut [f32]) {
    for value in values {
        *value = if *value > 0.0 { *value } else { 0.0 };
    }
}
