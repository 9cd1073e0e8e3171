//! Why a file was refused: which node or tensor, what was found, what was expected.

use super::proto::Node;
use crate::network::ShapeError;

/// Why an ONNX file was refused.
#[derive(Debug, thiserror::Error)]
pub enum OnnxError {
    /// The bytes are no ONNX file.
    #[error("no ONNX file, or a damaged one: {0}")]
    Decode(#[from] prost::DecodeError),
    /// Operators that no network of the family has.
    #[error("operators that cannot be imported: {0}; expected only {known}", known = super::recognise::OPERATORS.join(", "))]
    Operators(String),
    /// A node does something else than a network of the family.
    #[error("node `{node}` ({operator}): {what}: found {found}, expected {expected}")]
    Node {
        /// Name of the node, or of its output when it has none.
        node: String,
        /// Its operator.
        operator: String,
        /// Attribute, input or the like.
        what: String,
        /// What is there.
        found: String,
        /// What should be.
        expected: String,
    },
    /// A constant cannot be taken.
    #[error("tensor `{tensor}`: {what}: found {found}, expected {expected}")]
    Tensor {
        /// Name of the tensor.
        tensor: String,
        /// Size, type or the like.
        what: &'static str,
        /// What is there.
        found: String,
        /// What should be.
        expected: String,
    },
    /// The file as a whole.
    #[error("{what}: found {found}, expected {expected}")]
    Model {
        /// Field.
        what: &'static str,
        /// What is there.
        found: String,
        /// What should be.
        expected: String,
    },
    /// The network is none of the family.
    #[error("{0}")]
    Shape(#[from] ShapeError),
}

/// Name of a node for messages.
pub(super) fn name(node: &Node) -> String {
    let own = Some(&node.name).filter(|name| !name.is_empty());
    own.or(node.output.first()).cloned().unwrap_or_default()
}

/// A node that does something else than expected.
pub(super) fn at(node: &Node, what: &str, found: impl ToString, expected: impl ToString) -> OnnxError {
    OnnxError::Node {
        node: name(node),
        operator: node.op_type.clone(),
        what: what.to_owned(),
        found: found.to_string(),
        expected: expected.to_string(),
    }
}
