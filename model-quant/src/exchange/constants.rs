//! Constants of a graph: f32 weights and integer lists, with lengths that match their axes.

use super::error::{OnnxError, node_error};
use super::proto::{Attribute, Graph, Node, Tensor, data_type};
use std::collections::HashMap;

/// Weights with the sizes of their axes; the last axis is contiguous.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Weights {
    /// Sizes.
    pub sizes: Vec<usize>,
    /// Elements.
    pub values: Vec<f32>,
}

/// Constants of a graph by name.
pub(crate) struct Constants<'g> {
    tensors: HashMap<&'g str, &'g Tensor>,
}

impl<'g> Constants<'g> {
    /// Collects the initialisers and `Constant` nodes of a graph.
    pub(crate) fn from_graph(graph: &'g Graph) -> Self {
        let initialisers = graph.initializer.iter().map(|tensor| (tensor.name.as_str(), tensor));
        let nodes = graph.node.iter().filter(|node| node.op_type == "Constant").filter_map(|node| {
            let tensor = attribute(node, "value")?.t.as_ref()?;
            Some((node.output.first()?.as_str(), tensor))
        });
        Self { tensors: initialisers.chain(nodes).collect() }
    }

    /// Returns true if a value is a constant.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.tensors.contains_key(name)
    }

    fn input(&self, node: &'g Node, index: usize, what: &str) -> Result<(&'g str, &'g Tensor), OnnxError> {
        let missing = || node_error(node, what, "none", "a constant");
        let name = node.input.get(index).filter(|name| !name.is_empty()).ok_or_else(missing)?;
        let tensor = self.tensors.get(name.as_str());
        let tensor = tensor.ok_or_else(|| {
            node_error(node, what, format!("`{name}`, computed by the graph"), "a constant")
        })?;
        Ok((name, tensor))
    }

    /// Weights at an input of a node.
    pub(crate) fn weights(&self, node: &'g Node, index: usize, what: &str) -> Result<Weights, OnnxError> {
        let (name, tensor) = self.input(node, index, what)?;
        let sizes = sizes(name, tensor)?;
        let values = elements(name, tensor, data_type::FLOAT, &tensor.float_data, f32::from_le_bytes)?;
        if let Some(value) = values.iter().find(|value| !value.is_finite()) {
            return Err(wrong(name, "value", value, "finite numbers"));
        }
        Ok(Weights { sizes, values })
    }

    /// Integers at an input of a node: an axis list or a shape.
    pub(crate) fn integers(&self, node: &'g Node, index: usize, what: &str) -> Result<Vec<i64>, OnnxError> {
        let (name, tensor) = self.input(node, index, what)?;
        elements(name, tensor, data_type::INT64, &tensor.int64_data, i64::from_le_bytes)
    }
}

fn wrong(tensor: &str, what: &'static str, found: impl ToString, expected: impl ToString) -> OnnxError {
    let (found, expected) = (found.to_string(), expected.to_string());
    OnnxError::Tensor { tensor: tensor.to_owned(), what, found, expected }
}

fn sizes(name: &str, tensor: &Tensor) -> Result<Vec<usize>, OnnxError> {
    let size =
        |&size: &i64| usize::try_from(size).map_err(|_| wrong(name, "size of an axis", size, "0 or above"));
    tensor.dims.iter().map(size).collect()
}

/// Elements of a tensor: raw bytes or typed fields.
fn elements<T: Copy, const BYTES: usize>(
    name: &str,
    tensor: &Tensor,
    expected: i32,
    typed: &[T],
    read: impl Fn([u8; BYTES]) -> T,
) -> Result<Vec<T>, OnnxError> {
    if tensor.data_type != expected {
        return Err(wrong(name, "type", data_type::name(tensor.data_type), data_type::name(expected)));
    }
    if tensor.data_location != 0 {
        return Err(wrong(name, "elements", "external data", "elements inside the ONNX file"));
    }
    let sizes = sizes(name, tensor)?;
    let count = sizes.iter().try_fold(1usize, |count, &size| count.checked_mul(size));
    let (raw, cut) = tensor.raw_data.as_chunks::<BYTES>();
    let values: Vec<T> =
        if raw.is_empty() { typed.to_vec() } else { raw.iter().map(|&bytes| read(bytes)).collect() };
    if count != Some(values.len()) || !cut.is_empty() {
        let found = format!("{} elements", values.len());
        return Err(wrong(name, "elements", found, format!("as many as the sizes {sizes:?} have")));
    }
    Ok(values)
}

/// Attribute of a node by name.
pub(crate) fn attribute<'n>(node: &'n Node, name: &str) -> Option<&'n Attribute> {
    node.attribute.iter().find(|attribute| attribute.name == name)
}

/// Integer attribute of a node, or its default.
pub(crate) fn integer(node: &Node, name: &str, default: i64) -> i64 {
    attribute(node, name).map_or(default, |attribute| attribute.i)
}

/// Number attribute of a node, or its default.
pub(crate) fn number(node: &Node, name: &str, default: f32) -> f32 {
    attribute(node, name).map_or(default, |attribute| attribute.f)
}

/// Bias of every output; a single value applies to all.
pub(crate) fn biases(node: &Node, weights: &Weights, outputs: usize) -> Result<Vec<f32>, OnnxError> {
    match weights.values[..] {
        [one] => Ok(vec![one; outputs]),
        _ if weights.values.len() == outputs => Ok(weights.values.clone()),
        _ => Err(node_error(
            node,
            "bias",
            format!("{} values", weights.values.len()),
            format!("{outputs} values"),
        )),
    }
}
