//! Import: from an ONNX graph to a network.
//!
//! The graph must be a single chain from its only input to its only output: convolutions (stride 1,
//! dilation 1, one group, all 'valid' or all 'same'), each followed by ReLU, then flattening in
//! either order, then dense layers. A dense layer with ReLU before the last one becomes a
//! convolution over all its columns. Transposes, axes of size 1 and separate bias nodes are
//! supported. Everything else is refused with the name of the node. Source of the operators'
//! definitions: the ONNX specification, sets 7 to 26.

use super::axes::{Axis, Meaning, flatten, reshape, squeeze, transpose, unsqueeze};
use super::chain::Chain;
use super::constants::Constants;
pub use super::error::OPERATORS;
use super::error::{OnnxError, name, node_error};
pub use super::layout::Layout;
use super::proto::{Graph, Model, Node, Value, data_type};
use crate::network::{MAX_SIZE, Network};
use prost::Message;

/// Supported versions of the standard operator set.
const OPSETS: std::ops::RangeInclusive<i64> = 7..=26;

/// Maximum number of unsupported nodes named in a message.
const NAMED: usize = 6;

/// A network found in an ONNX file.
#[derive(Clone, Debug, PartialEq)]
pub struct Imported {
    /// The network.
    pub network: Network,
    /// Axes of the file's input.
    pub layout: Layout,
    /// Program that wrote the file, in one line.
    pub producer: String,
}

/// Imports an ONNX file.
///
/// # Errors
///
/// The node that no supported network contains.
pub fn import(bytes: &[u8]) -> Result<Imported, OnnxError> {
    let model = Model::decode(bytes)?;
    let missing =
        |what, expected: &str| OnnxError::Model { what, found: "none".into(), expected: expected.into() };
    let graph = model.graph.as_ref().ok_or_else(|| missing("graph", "one graph"))?;
    let standard = model.opset_import.iter().find(|set| is_standard(&set.domain));
    let version = standard.ok_or_else(|| missing("operator set", "the standard set"))?.version;
    if !OPSETS.contains(&version) {
        let expected = format!("{} to {}", OPSETS.start(), OPSETS.end());
        return Err(OnnxError::Model {
            what: "version of the standard operators",
            found: version.to_string(),
            expected,
        });
    }
    check_operators(graph)?;
    let constants = Constants::from_graph(graph);
    let input = only("inputs", graph.input.iter().filter(|input| !constants.has(&input.name)))?;
    let output = only("outputs", graph.output.iter())?;
    let (mut axes, mut chain) = (input_axes(input)?, Chain::new());
    let mut value = input.name.as_str();
    // A graph may be a ring: every node is visited at most once.
    for _ in 0..=graph.node.len() {
        let Some(node) = next(graph, value)? else { break };
        axes = step(node, &constants, value, axes, &mut chain)?;
        value = node.output.first().map_or("", String::as_str);
        if value == output.name {
            break;
        }
    }
    if value != output.name {
        let expected = format!("a chain from the input to `{}`", output.name);
        return Err(OnnxError::Model {
            what: "graph",
            found: format!("a chain that ends at `{value}`"),
            expected,
        });
    }
    let (network, layout) = chain.finish()?;
    let producer = one_line(&format!("{} {}", model.producer_name, model.producer_version));
    Ok(Imported { network, layout, producer })
}

/// Joins a text to one line. It becomes part of a Rust comment, which a line break would end.
pub(crate) fn one_line(text: &str) -> String {
    text.split(|c: char| c.is_control() || c.is_whitespace())
        .filter(|word| !word.is_empty())
        .collect::<Vec<_>>()
        .join(" ")
}

fn is_standard(domain: &str) -> bool {
    domain.is_empty() || domain == "ai.onnx"
}

/// Names all unsupported operators before any other error is reported.
fn check_operators(graph: &Graph) -> Result<(), OnnxError> {
    let mut named: Vec<(String, &str)> = Vec::new();
    let mut further = 0;
    for node in &graph.node {
        let operator = node.op_type.as_str();
        let is_known = OPERATORS.contains(&operator) && is_standard(&node.domain);
        if is_known || named.iter().any(|(_, seen)| *seen == operator) {
            continue;
        }
        if named.len() < NAMED {
            named.push((name(node), operator));
        } else {
            further += 1;
        }
    }
    if named.is_empty() {
        return Ok(());
    }
    let named: Vec<String> =
        named.iter().map(|(node, operator)| format!("{operator} (node `{node}`)")).collect();
    let more = if further == 0 { String::new() } else { format!(" and {further} more") };
    Err(OnnxError::Operators(named.join(", ") + &more))
}

fn only<'g>(what: &'static str, values: impl Iterator<Item = &'g Value>) -> Result<&'g Value, OnnxError> {
    let values: Vec<&Value> = values.collect();
    match values[..] {
        [value] => Ok(value),
        _ => {
            let names: Vec<&str> = values.iter().map(|value| value.name.as_str()).collect();
            let found = format!("{} ({})", names.len(), names.join(", "));
            Err(OnnxError::Model { what, found, expected: "1".into() })
        }
    }
}

/// Axes of the input: batch and two more of known sizes.
fn input_axes(input: &Value) -> Result<Vec<Axis>, OnnxError> {
    let tensor = input.kind.as_ref().and_then(|kind| kind.tensor.as_ref());
    let element = tensor.map_or(0, |tensor| tensor.element);
    if element != data_type::FLOAT {
        let found = data_type::name(element);
        return Err(OnnxError::Model { what: "type of the input", found, expected: "FLOAT".into() });
    }
    let dimensions = tensor.and_then(|tensor| tensor.shape.as_ref()).map_or(&[][..], |shape| &shape.dim);
    let size = |place: usize| {
        let size = dimensions.get(place).and_then(|dimension| dimension.size);
        size.and_then(|size| usize::try_from(size).ok()).filter(|size| (1..=MAX_SIZE).contains(size))
    };
    match (dimensions.len(), size(1), size(2)) {
        (3, Some(first), Some(second)) => Ok(vec![
            Axis { meaning: Meaning::Batch, size: 1 },
            Axis { meaning: Meaning::First, size: first },
            Axis { meaning: Meaning::Second, size: second },
        ]),
        _ => {
            let size = |d: &super::proto::Dimension| d.size.map_or("?".to_owned(), |size| size.to_string());
            let found: Vec<String> = dimensions.iter().map(size).collect();
            let expected =
                format!("a batch and two axes of 1 to {MAX_SIZE}: columns and the values of a column");
            Err(OnnxError::Model {
                what: "axes of the input",
                found: format!("[{}]", found.join(", ")),
                expected,
            })
        }
    }
}

/// Returns the only consumer of a value; `None` at the end.
fn next<'g>(graph: &'g Graph, value: &str) -> Result<Option<&'g Node>, OnnxError> {
    let mut takers = graph.node.iter().filter(|node| node.input.iter().any(|input| input == value));
    let Some(node) = takers.next() else { return Ok(None) };
    match takers.next() {
        Some(other) => {
            let found = format!("node `{}` also reads `{value}`", name(other));
            Err(node_error(node, "input", found, "a chain without branches"))
        }
        None => Ok(Some(node)),
    }
}

/// Processes one node.
fn step<'g>(
    node: &'g Node,
    constants: &Constants<'g>,
    value: &str,
    axes: Vec<Axis>,
    chain: &mut Chain,
) -> Result<Vec<Axis>, OnnxError> {
    let is_first = node.input.first().is_some_and(|input| input == value);
    if !is_first && node.op_type != "Add" {
        return Err(node_error(
            node,
            "input",
            format!("`{value}` not as the first input"),
            "the chain's value first",
        ));
    }
    match node.op_type.as_str() {
        "Identity" | "Dropout" => Ok(axes),
        "Transpose" => transpose(node, &axes),
        "Squeeze" => squeeze(node, constants, &axes),
        "Unsqueeze" => unsqueeze(node, constants, &axes),
        "Reshape" => reshape(node, constants, &axes),
        "Flatten" => flatten(node, &axes),
        "Conv" => chain.convolution(node, constants, axes),
        "Add" => chain.bias(node, constants, usize::from(is_first), axes),
        "Relu" => chain.rectify(node, axes),
        "MatMul" | "Gemm" => chain.dense(node, constants, axes),
        operator => Err(node_error(node, "place", operator, "no constant inside the chain")),
    }
}
