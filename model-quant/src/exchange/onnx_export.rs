//! Export of a float network to ONNX in the form of PyTorch: batch x values x columns, `Conv`,
//! `Relu`, `Flatten`, `Gemm`.
//!
//! IR version 10, operator set 21 (ONNX Runtime 1.20 and later). All weights are stored in the file
//! as raw f32; importing the file ([`super::onnx_import::import`]) gives the same weights bit for
//! bit.

use super::proto::{
    Attribute, Axes, Dimension, Graph, Kind, Model, Node, OperatorSet, Property, Tensor, TensorKind, Value,
    data_type,
};
use super::weight_order::convolution_weights;
use crate::network::Network;
use prost::Message;

/// Version of the format.
const IR_VERSION: i64 = 10;
/// Version of the operators.
const OPSET: i64 = 21;
/// Name of the input.
pub(crate) const INPUT: &str = "columns";
/// Name of the output.
pub(crate) const OUTPUT: &str = "outputs";

fn tensor(name: String, sizes: &[usize], values: &[f32]) -> Tensor {
    Tensor {
        dims: sizes.iter().map(|&size| size as i64).collect(),
        data_type: data_type::FLOAT,
        name,
        raw_data: values.iter().flat_map(|value| value.to_le_bytes()).collect(),
        ..Tensor::default()
    }
}

fn integer(name: &str, i: i64) -> Attribute {
    Attribute { name: name.to_owned(), i, kind: 2, ..Attribute::default() }
}

fn integers(name: &str, ints: Vec<i64>) -> Attribute {
    Attribute { name: name.to_owned(), ints, kind: 7, ..Attribute::default() }
}

fn value(name: &str, sizes: &[usize]) -> Value {
    let batch = Dimension { size: None, name: Some("batch".to_owned()) };
    let sizes = sizes.iter().map(|&size| Dimension { size: Some(size as i64), name: None });
    let shape = Axes { dim: std::iter::once(batch).chain(sizes).collect() };
    let tensor = TensorKind { element: data_type::FLOAT, shape: Some(shape) };
    Value { name: name.to_owned(), kind: Some(Kind { tensor: Some(tensor) }) }
}

fn node(operator: &str, name: &str, inputs: &[&str], output: &str, attribute: Vec<Attribute>) -> Node {
    Node {
        input: inputs.iter().map(|&input| input.to_owned()).collect(),
        output: vec![output.to_owned()],
        name: name.to_owned(),
        op_type: operator.to_owned(),
        attribute,
        domain: String::new(),
    }
}

/// Encodes a file; `metadata` are pairs of name and text.
pub fn to_bytes(network: &Network, name: &str, metadata: &[(&str, String)]) -> Vec<u8> {
    let shape = network.shape();
    let (mut nodes, mut initializer) = (Vec::new(), Vec::new());
    let mut before = INPUT.to_owned();
    let sizes = shape.layers();
    let last = sizes.len().saturating_sub(1);
    for (index, (size, layer)) in sizes.iter().zip(network.layers()).enumerate() {
        let layer_name = layer_name(index, last);
        let [weight, bias] = ["weight", "bias"].map(|what| format!("{layer_name}.{what}"));
        initializer.push(tensor(bias.clone(), &[size.outputs], &layer.biases));
        if index == last {
            // A head is a convolution over all its columns.
            initializer.push(tensor(
                weight.clone(),
                &[size.outputs, size.taps()],
                &convolution_weights(layer, size),
            ));
            nodes.push(node("Flatten", "flatten", &[&before], "flat", vec![integer("axis", 1)]));
            nodes.push(node(
                "Gemm",
                &layer_name,
                &["flat", &weight, &bias],
                OUTPUT,
                vec![integer("transB", 1)],
            ));
        } else {
            let axes = [size.outputs, size.inputs, size.kernel];
            initializer.push(tensor(weight.clone(), &axes, &convolution_weights(layer, size)));
            let after = size.positions + size.kernel - 1 - size.columns - size.before;
            let attributes = vec![
                integers("kernel_shape", vec![size.kernel as i64]),
                integers("pads", vec![size.before as i64, after as i64]),
                integers("strides", vec![1]),
                integers("dilations", vec![1]),
                integer("group", 1),
            ];
            let (sums, rectified) = (format!("{layer_name}.sums"), format!("{layer_name}.outputs"));
            nodes.push(node("Conv", &layer_name, &[&before, &weight, &bias], &sums, attributes));
            nodes.push(node("Relu", &format!("{layer_name}.relu"), &[&sums], &rectified, Vec::new()));
            before = rectified;
        }
    }
    let graph = Graph {
        node: nodes,
        name: name.to_owned(),
        initializer,
        input: vec![value(INPUT, &[shape.inputs, shape.columns])],
        output: vec![value(OUTPUT, &[shape.outputs])],
    };
    let property = |(key, value): &(&str, String)| Property { key: (*key).to_owned(), value: value.clone() };
    let model = Model {
        ir_version: IR_VERSION,
        producer_name: "model-quant".to_owned(),
        producer_version: env!("CARGO_PKG_VERSION").to_owned(),
        doc_string: String::new(),
        graph: Some(graph),
        opset_import: vec![OperatorSet { domain: String::new(), version: OPSET }],
        metadata_props: metadata.iter().map(property).collect(),
    };
    model.encode_to_vec()
}

/// Name of a layer: `convolution_1`, `convolution_2` ..., `head`.
pub(super) fn layer_name(index: usize, last: usize) -> String {
    if index == last { "head".to_owned() } else { format!("convolution_{}", index + 1) }
}
