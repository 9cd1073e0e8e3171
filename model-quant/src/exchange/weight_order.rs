//! Conversion of weights from and to the order of PyTorch and ONNX: outputs x inputs x columns.
//!
//! The order here is by column, then input, then output ([`crate::network::Layer`]).

use crate::network::{Layer, LayerSize};

/// Converts a layer to outputs x inputs x columns. A head is a convolution over all its columns,
/// after flattening inputs x columns.
pub(crate) fn convolution_weights(layer: &Layer, size: &LayerSize) -> Vec<f32> {
    let mut theirs = vec![0.0; size.weights()];
    for (tap, row) in layer.weights.chunks_exact(size.outputs).enumerate() {
        for (output, &weight) in row.iter().enumerate() {
            let (column, input) = (tap / size.inputs, tap % size.inputs);
            if let Some(slot) = theirs.get_mut((output * size.inputs + input) * size.kernel + column) {
                *slot = weight;
            }
        }
    }
    theirs
}

/// Converts weights of outputs x inputs x columns to the order by column, input and output.
pub fn from_convolution(theirs: &[f32], inputs: usize, kernel: usize, outputs: usize) -> Vec<f32> {
    let mut ours = vec![0.0; theirs.len()];
    for (output, rows) in theirs.chunks_exact(inputs * kernel).enumerate() {
        for (input, row) in rows.chunks_exact(kernel).enumerate() {
            for (column, &weight) in row.iter().enumerate() {
                if let Some(slot) = ours.get_mut((column * inputs + input) * outputs + output) {
                    *slot = weight;
                }
            }
        }
    }
    ours
}

/// Transposes a matrix with rows of this length.
pub(crate) fn transposed(values: &[f32], length: usize) -> Vec<f32> {
    (0..length).flat_map(|place| values.iter().skip(place).step_by(length).copied()).collect()
}
