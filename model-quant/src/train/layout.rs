//! Memory layout of a network's parameters during training.
//!
//! One array, layer by layer, weights before biases. The output channels of a convolution are
//! padded to a multiple of eight. Padding weights are zero and stay zero: their outputs and
//! gradients are zero. The head is ordered by output. Convolutions with multiples of eight channels
//! need no padding.

use super::lanes::LANES;
use crate::network::{LayerSize, Network, Shape};
use core::ops::Range;

/// Position of one layer.
#[derive(Clone, Debug)]
pub(super) struct Place {
    /// Sizes with padding channels.
    pub(super) size: LayerSize,
    /// Sizes of the network.
    real: LayerSize,
    pub(super) weights: Range<usize>,
    pub(super) biases: Range<usize>,
    is_head: bool,
}

impl Place {
    /// Index of a weight in the array, from its index in the network.
    fn weight(&self, index: usize) -> usize {
        let (tap, output) = (index / self.real.outputs, index % self.real.outputs);
        let (column, input) = (tap / self.real.inputs, tap % self.real.inputs);
        let tap = column * self.size.inputs + input;
        let within =
            if self.is_head { output * self.size.taps() + tap } else { tap * self.size.outputs + output };
        self.weights.start + within
    }
}

/// Positions of all layers.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    pub(super) shape: Shape,
    pub(super) convolutions: Vec<Place>,
    pub(super) head: Place,
    pub(super) length: usize,
}

impl Layout {
    pub(super) fn new(shape: &Shape) -> Self {
        let (mut start, mut inputs) = (0, shape.inputs);
        let mut places = Vec::new();
        let sizes = shape.layers();
        for (index, real) in sizes.iter().enumerate() {
            let is_head = index + 1 == sizes.len();
            let outputs = if is_head { real.outputs } else { real.outputs.next_multiple_of(LANES) };
            let size = LayerSize { inputs, outputs, ..*real };
            let weights = start..start + size.weights();
            let biases = weights.end..weights.end + outputs;
            (start, inputs) = (biases.end, outputs);
            places.push(Place { size, real: *real, weights, biases, is_head });
        }
        let head = places.remove(places.len() - 1);
        Self { shape: shape.clone(), convolutions: places, head, length: start }
    }

    /// Number of values of a window.
    pub(super) fn window(&self) -> usize {
        self.shape.columns * self.shape.inputs
    }

    fn places(&self) -> impl Iterator<Item = &Place> {
        self.convolutions.iter().chain([&self.head])
    }

    /// Copies a network's parameters into an array.
    pub(super) fn pack(&self, network: &Network) -> Vec<f32> {
        let mut packed = vec![0.0; self.length];
        for (place, layer) in self.places().zip(network.layers()) {
            for (index, weight) in layer.weights.iter().enumerate() {
                packed[place.weight(index)] = *weight;
            }
            for (slot, bias) in packed[place.biases.clone()].iter_mut().zip(&layer.biases) {
                *slot = *bias;
            }
        }
        packed
    }

    /// Creates a network from an array.
    pub(super) fn unpack(&self, packed: &[f32]) -> Network {
        let mut network = Network::zero(self.shape.clone());
        let mut slices = network.slices_mut();
        for place in self.places() {
            for (index, weight) in slices.next().into_iter().flatten().enumerate() {
                *weight = packed[place.weight(index)];
            }
            for (bias, value) in slices.next().into_iter().flatten().zip(&packed[place.biases.clone()]) {
                *bias = *value;
            }
        }
        drop(slices);
        network
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::draw::{Draw, Purpose};
    use crate::network::{ConvolutionShape, Padding};

    #[test]
    fn packing_is_lossless_and_pads_with_zeros() {
        for (first, second) in [(8, 16), (5, 12), (1, 3)] {
            let shape = Shape {
                columns: 9,
                inputs: 3,
                padding: Padding::Same,
                convolutions: vec![
                    ConvolutionShape { kernel: 4, outputs: first },
                    ConvolutionShape { kernel: 3, outputs: second },
                ],
                outputs: 2,
            };
            let network = Network::start(shape.clone(), &mut Draw::new(1, Purpose::Weights, 0));
            let layout = Layout::new(&shape);
            let packed = layout.pack(&network);
            assert_eq!(layout.unpack(&packed), network);
            let filled = packed.iter().filter(|&&value| value != 0.0).count();
            assert_eq!(filled, network.parameters().filter(|&value| value != 0.0).count());
        }
    }
}
