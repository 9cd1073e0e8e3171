//! How a network's parameters lie while it is trained.
//!
//! One run of numbers, layer by layer, weights before biases. The channels behind a convolution are filled up to a
//! multiple of eight with zeros, which stay zeros: nothing comes out of them and nothing comes back. A head lies output
//! by output. For networks whose convolutions have multiples of eight channels there is nothing to fill up.

use super::lanes::LANES;
use crate::network::{LayerSize, Network, Shape};
use core::ops::Range;

/// One layer's place.
#[derive(Clone, Debug)]
pub(super) struct Place {
    /// Sizes with the channels filled up.
    pub(super) size: LayerSize,
    /// Sizes as the network has them.
    real: LayerSize,
    pub(super) weights: Range<usize>,
    pub(super) biases: Range<usize>,
    is_head: bool,
}

impl Place {
    /// Where a weight of the network lies, by its position there.
    fn weight(&self, index: usize) -> usize {
        let (tap, output) = (index / self.real.outputs, index % self.real.outputs);
        let (column, input) = (tap / self.real.inputs, tap % self.real.inputs);
        let tap = column * self.size.inputs + input;
        let within =
            if self.is_head { output * self.size.taps() + tap } else { tap * self.size.outputs + output };
        self.weights.start + within
    }
}

/// Places of all layers.
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

    /// Numbers in a window.
    pub(super) fn window(&self) -> usize {
        self.shape.columns * self.shape.inputs
    }

    fn places(&self) -> impl Iterator<Item = &Place> {
        self.convolutions.iter().chain([&self.head])
    }

    /// The parameters of a network in their places.
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

    /// The network of parameters in their places.
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
    use crate::draw::{Draw, Purpose};
    use crate::network::{ConvolutionShape, Padding};

    #[test]
    fn packing_loses_nothing_and_fills_with_zeros() {
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
