//! Reasons why an ONNX file is refused: node or tensor, content found, content expected.

use super::proto::Node;
use crate::network::ShapeError;

/// Supported operators.
pub const OPERATORS: [&str; 13] = [
    "Add",
    "Constant",
    "Conv",
    "Dropout",
    "Flatten",
    "Gemm",
    "Identity",
    "MatMul",
    "Relu",
    "Reshape",
    "Squeeze",
    "Transpose",
    "Unsqueeze",
];

/// Reason why an ONNX file was refused.
#[derive(Debug, thiserror::Error)]
pub enum OnnxError {
    /// The bytes are not an ONNX file.
    #[error("no ONNX file, or a damaged one: {0}")]
    Decode(#[from] prost::DecodeError),
    /// Operators that no supported network contains.
    #[error(
        "operators that cannot be imported: {0}; expected only {known}",
        known = OPERATORS.join(", ")
    )]
    Operators(String),
    /// A node differs from those of a supported network.
    #[error("node `{node}` ({operator}): {what}: found {found}, expected {expected}")]
    Node {
        /// Name of the node, or of its output if it has none.
        node: String,
        /// Its operator.
        operator: String,
        /// Attribute, input or the like.
        what: String,
        /// Content found.
        found: String,
        /// Content expected.
        expected: String,
    },
    /// A constant is unusable.
    #[error("tensor `{tensor}`: {what}: found {found}, expected {expected}")]
    Tensor {
        /// Name of the tensor.
        tensor: String,
        /// Size, type or the like.
        what: &'static str,
        /// Content found.
        found: String,
        /// Content expected.
        expected: String,
    },
    /// The file in general.
    #[error("{what}: found {found}, expected {expected}")]
    Model {
        /// Field.
        what: &'static str,
        /// Content found.
        found: String,
        /// Content expected.
        expected: String,
    },
    /// The network is not supported.
    #[error("{0}")]
    Shape(#[from] ShapeError),
}

/// Name of a node for messages.
pub(super) fn name(node: &Node) -> String {
    let own = Some(&node.name).filter(|name| !name.is_empty());
    own.or(node.output.first()).cloned().unwrap_or_default()
}

/// Creates the error of an unexpected node.
pub(super) fn node_error(
    node: &Node,
    what: &str,
    found: impl ToString,
    expected: impl ToString,
) -> OnnxError {
    OnnxError::Node {
        node: name(node),
        operator: node.op_type.clone(),
        what: what.to_owned(),
        found: found.to_string(),
        expected: expected.to_string(),
    }
}
