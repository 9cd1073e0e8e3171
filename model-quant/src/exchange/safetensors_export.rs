//! Export of the trained weights of a bearing to safetensors: `NETWORK.LAYER.weight` and `.bias` in
//! the order of PyTorch.
//!
//! Every network is stored twice: the float weights, and as `NETWORK_on_grid` the weights trained
//! on the 8-bit grid. The metadata has one entry `model-quant`, a JSON object with bearing,
//! training id, recipe, ranges and the meaning of the inputs. It is a single entry because the
//! writer does not preserve an order.

use super::description::{describe_network, describe_origin};
use super::onnx_export::layer_name;
use super::weight_order::convolution_weights;
use crate::network::checkpoint::Checkpoint;
use crate::network::{Network, NetworkKind};
use safetensors::tensor::TensorView;
use safetensors::{Dtype, SafeTensorError};
use std::collections::HashMap;

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

/// Encodes a file.
///
/// # Errors
///
/// Those of the safetensors writer.
pub fn to_bytes(checkpoint: &Checkpoint, training_id: u64) -> Result<Vec<u8>, SafeTensorError> {
    let mut metadata = describe_origin(checkpoint, training_id);
    let mut all = Vec::new();
    for which in NetworkKind::ALL {
        let found = checkpoint.trained(which);
        all.extend(tensors(which.name(), &found.float));
        all.extend(tensors(&format!("{}_on_grid", which.name()), &found.tuned));
        if let Some(metadata) = metadata.as_object_mut() {
            metadata.insert(which.name().to_owned(), describe_network(checkpoint, which));
        }
    }
    let mut views = Vec::with_capacity(all.len());
    for (name, sizes, bytes) in &all {
        views.push((name, TensorView::new(Dtype::F32, sizes.clone(), bytes)?));
    }
    let metadata = HashMap::from([("model-quant".to_owned(), metadata.to_string())]);
    safetensors::serialize(views, Some(metadata))
}
