//! The trained weights of a bearing as safetensors: `NETWORK.LAYER.weight` and `.bias` in the order of PyTorch.
//!
//! Every network is in it twice: as it was trained, and `NETWORK_on_grid`: after the training on the 8-bit grid. Metadata: one entry
//! `model-quant` with a JSON object (bearing, training id, recipe, ranges, what the values of a column are); one entry only,
//! because the format's writer does not keep an order.

use super::description::{Which, network as described, origin};
use super::frameworks::convolution_weights;
use super::onnx::layer_name;
use crate::checkpoint::Checkpoint;
use crate::network::Network;
use crate::train::Trained;
use safetensors::tensor::TensorView;
use safetensors::{Dtype, SafeTensorError};
use std::collections::HashMap;

/// A network of a checkpoint.
pub fn trained(checkpoint: &Checkpoint, which: Which) -> &Trained {
    match which {
        Which::Collision => &checkpoint.collision,
        Which::Friction => &checkpoint.friction,
    }
}

/// Name, sizes and bytes of every tensor of a network.
fn tensors(prefix: &str, network: &Network) -> Vec<(String, Vec<usize>, Vec<u8>)> {
    let bytes = |values: &[f32]| values.iter().flat_map(|value| value.to_le_bytes()).collect();
    let sizes = network.shape().layers();
    let last = sizes.len().saturating_sub(1);
    (sizes.iter().zip(network.layers()).enumerate())
        .flat_map(|(index, (size, layer))| {
            let name = format!("{prefix}.{}", layer_name(index, last));
            let axes = if index == last {
                vec![size.outputs, size.taps()]
            } else {
                vec![size.outputs, size.inputs, size.kernel]
            };
            [
                (format!("{name}.weight"), axes, bytes(&convolution_weights(layer, size))),
                (format!("{name}.bias"), vec![size.outputs], bytes(&layer.biases)),
            ]
        })
        .collect()
}

/// The bytes of a file.
///
/// # Errors
///
/// None but those of the format's writer.
pub fn to_bytes(checkpoint: &Checkpoint, training_id: u64) -> Result<Vec<u8>, SafeTensorError> {
    let mut metadata = origin(checkpoint, training_id);
    let mut all = Vec::new();
    for which in Which::ALL {
        let found = trained(checkpoint, which);
        all.extend(tensors(which.name(), &found.float));
        all.extend(tensors(&format!("{}_on_grid", which.name()), &found.tuned));
        if let Some(metadata) = metadata.as_object_mut() {
            metadata.insert(which.name().to_owned(), described(checkpoint, which));
        }
    }
    let mut views = Vec::with_capacity(all.len());
    for (name, sizes, bytes) in &all {
        views.push((name, TensorView::new(Dtype::F32, sizes.clone(), bytes)?));
    }
    let metadata = HashMap::from([("model-quant".to_owned(), metadata.to_string())]);
    safetensors::serialize(views, Some(metadata))
}
