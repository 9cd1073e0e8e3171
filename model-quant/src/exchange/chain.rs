//! Layers of a network, collected while its graph is followed.

use super::axes::{Axis, Meaning};
use super::constants::{Constants, attribute, biases, integer, number};
use super::error::{OnnxError, name, node_error};
use super::layout::Layout;
use super::padding::padding;
use super::proto::Node;
use super::weight_order::{from_convolution, transposed};
use crate::network::{ConvolutionShape, Layer, MAX_SIZE, Network, Padding, Shape};

/// Layer whose ReLU or end has not been reached yet.
struct Open {
    /// Name of its node.
    node: String,
    /// Its operator.
    operator: String,
    layer: Layer,
    kernel: usize,
    is_dense: bool,
    has_bias: bool,
}

/// State of the walk through the graph.
pub(super) struct Chain {
    layout: Option<(Layout, usize, usize)>,
    padding: Option<Padding>,
    convolutions: Vec<ConvolutionShape>,
    layers: Vec<Layer>,
    open: Option<Open>,
}

impl Chain {
    pub(super) fn new() -> Self {
        Self { layout: None, padding: None, convolutions: Vec::new(), layers: Vec::new(), open: None }
    }

    /// Appends the open layer to the convolutions.
    fn close(&mut self) {
        if let Some(open) = self.open.take() {
            self.convolutions
                .push(ConvolutionShape { kernel: open.kernel, outputs: open.layer.biases.len() });
            self.layers.push(open.layer);
        }
    }

    /// Refuses a layer that follows a layer without ReLU.
    fn check_closed(&self, node: &Node) -> Result<(), OnnxError> {
        match &self.open {
            Some(open) => {
                let found = format!("{} after `{}` ({})", node.op_type, open.node, open.operator);
                Err(node_error(node, "input", found, "ReLU between two layers"))
            }
            None => Ok(()),
        }
    }

    /// `Conv`: over batch x channels x columns, perhaps with a further axis of size 1.
    pub(super) fn convolution(
        &mut self,
        node: &Node,
        constants: &Constants<'_>,
        axes: Vec<Axis>,
    ) -> Result<Vec<Axis>, OnnxError> {
        self.check_closed(node)?;
        let spatial = axes.len().saturating_sub(2);
        check_plain_convolution(node, spatial)?;
        let (channels, columns, place) = self.orient(node, &axes)?;
        let weights = constants.weights(node, 1, "weights")?;
        let (outputs, kernel) = kernel_sizes(node, &weights.sizes, (spatial, channels, place))?;
        self.agree_on_padding(node, padding(node, spatial, place, kernel)?)?;
        let left = self.columns_after(node, columns, kernel)?;
        let biases = match node.input.get(2).filter(|name| !name.is_empty()) {
            Some(_) => Some(biases(node, &constants.weights(node, 2, "bias")?, outputs)?),
            None => None,
        };
        let ours = from_convolution(&weights.values, channels, kernel, outputs);
        self.begin(node, ours, biases, outputs, kernel, false);
        let mut found = axes;
        for (at, axis) in found.iter_mut().enumerate() {
            if at == 1 {
                *axis = Axis { meaning: Meaning::Channels, size: outputs };
            } else if at == place {
                *axis = Axis { meaning: Meaning::Columns, size: left };
            }
        }
        Ok(found)
    }

    /// Refuses a padding that differs from that of the convolutions before.
    fn agree_on_padding(&mut self, node: &Node, padding: Option<Padding>) -> Result<(), OnnxError> {
        match (self.padding, padding) {
            (Some(before), Some(now)) if before != now => {
                let [found, expected] = [now, before].map(Padding::name);
                let expected = format!("{expected} as the convolutions before it");
                Err(node_error(node, "pads", found, expected))
            }
            (None, now) => {
                self.padding = now;
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// Number of columns after a convolution.
    fn columns_after(&self, node: &Node, columns: usize, kernel: usize) -> Result<usize, OnnxError> {
        if self.padding == Some(Padding::Same) {
            return Ok(columns);
        }
        (columns + 1).checked_sub(kernel).filter(|&left| left > 0).ok_or_else(|| {
            let expected = format!("at most the {columns} remaining columns");
            node_error(node, "kernel", format!("{kernel} columns"), expected)
        })
    }

    /// Finds the column axis; returns channels, columns and its index. The first convolution
    /// decides the meaning of the input's axes.
    fn orient(&mut self, node: &Node, axes: &[Axis]) -> Result<(usize, usize, usize), OnnxError> {
        let wrong = || {
            let found: Vec<String> =
                axes.iter().map(|axis| format!("{:?}", axis.meaning).to_lowercase()).collect();
            node_error(node, "axes of the input", found.join(" x "), "batch x channels x columns")
        };
        let [Axis { meaning: Meaning::Batch, .. }, channels, spatial @ ..] = axes else {
            return Err(wrong());
        };
        let mut wide = spatial.iter().enumerate().filter(|(_, axis)| axis.meaning != Meaning::One);
        let (Some((place, columns)), None, 1..=2) = (wide.next(), wide.next(), spatial.len()) else {
            return Err(wrong());
        };
        match (channels.meaning, columns.meaning) {
            (Meaning::Channels, Meaning::Columns) => {}
            (Meaning::First, Meaning::Second) => {
                self.layout = Some((Layout::ChannelsFirst, columns.size, channels.size));
            }
            (Meaning::Second, Meaning::First) => {
                self.layout = Some((Layout::ColumnsFirst, columns.size, channels.size));
            }
            _ => return Err(wrong()),
        }
        Ok((channels.size, columns.size, place + 2))
    }

    /// `Gemm` or `MatMul` of a flattened value.
    pub(super) fn dense(
        &mut self,
        node: &Node,
        constants: &Constants<'_>,
        axes: Vec<Axis>,
    ) -> Result<Vec<Axis>, OnnxError> {
        self.check_closed(node)?;
        let (batch, axis) = match axes[..] {
            [batch @ Axis { meaning: Meaning::Batch, .. }, axis] if axis.meaning.is_flat() => (batch, axis),
            _ => {
                return Err(node_error(
                    node,
                    "input",
                    format!("{} axes", axes.len()),
                    "batch x flattened values",
                ));
            }
        };
        let mut is_transposed = false;
        if node.op_type == "Gemm" {
            for (what, expected) in [("alpha", 1.0), ("beta", 1.0)] {
                let found = number(node, what, 1.0);
                if found != expected {
                    return Err(node_error(node, what, found, expected));
                }
            }
            if integer(node, "transA", 0) != 0 {
                return Err(node_error(node, "transA", integer(node, "transA", 0), 0));
            }
            is_transposed = integer(node, "transB", 0) != 0;
        }
        let weights = constants.weights(node, 1, "weights")?;
        let (taps, outputs) = match (&weights.sizes[..], is_transposed) {
            (&[taps, outputs], false) | (&[outputs, taps], true) => (taps, outputs),
            _ => {
                return Err(node_error(
                    node,
                    "sizes of the weights",
                    format!("{:?}", weights.sizes),
                    "two axes",
                ));
            }
        };
        if taps != axis.size || !(1..=MAX_SIZE).contains(&outputs) {
            let expected = format!("{} taps and 1 to {MAX_SIZE} outputs", axis.size);
            return Err(node_error(node, "sizes of the weights", format!("{:?}", weights.sizes), expected));
        }
        let channels = self.layers.last().map_or(axis.size, |layer| layer.biases.len());
        let columns = axis.size / channels.max(1);
        let rows = if is_transposed { weights.values } else { transposed(&weights.values, outputs) };
        let ours = match axis.meaning {
            Meaning::ByChannel => from_convolution(&rows, channels, columns, outputs),
            _ => transposed(&rows, taps),
        };
        let biases = match node.input.get(2).filter(|name| node.op_type == "Gemm" && !name.is_empty()) {
            Some(_) => Some(biases(node, &constants.weights(node, 2, "bias")?, outputs)?),
            None => None,
        };
        self.begin(node, ours, biases, outputs, columns, true);
        Ok(vec![batch, Axis { meaning: Meaning::Dense, size: outputs }])
    }

    fn begin(
        &mut self,
        node: &Node,
        weights: Vec<f32>,
        biases: Option<Vec<f32>>,
        outputs: usize,
        kernel: usize,
        is_dense: bool,
    ) {
        self.open = Some(Open {
            node: name(node),
            operator: node.op_type.clone(),
            has_bias: biases.is_some(),
            layer: Layer { weights, biases: biases.unwrap_or_else(|| vec![0.0; outputs]) },
            kernel,
            is_dense,
        });
    }

    /// `Add`: the bias of the open layer, given at input `place`.
    pub(super) fn bias(
        &mut self,
        node: &Node,
        constants: &Constants<'_>,
        place: usize,
        axes: Vec<Axis>,
    ) -> Result<Vec<Axis>, OnnxError> {
        let Some(open) = self.open.as_mut().filter(|open| !open.has_bias) else {
            return Err(node_error(node, "place", "Add", "only the bias of a convolution or a dense layer"));
        };
        let weights = constants.weights(node, place, "bias")?;
        let outputs = open.layer.biases.len();
        let is_along = |meaning| matches!(meaning, Meaning::Channels | Meaning::Dense);
        // The bias is aligned with the last axes; only the output axis may be larger than 1.
        let fits = weights.sizes.len() <= axes.len()
            && weights
                .sizes
                .iter()
                .rev()
                .zip(axes.iter().rev())
                .all(|(&size, axis)| size == 1 || is_along(axis.meaning) && size == outputs);
        if !fits {
            let expected = format!("{outputs} values along the outputs");
            return Err(node_error(node, "sizes of the bias", format!("{:?}", weights.sizes), expected));
        }
        open.layer.biases = biases(node, &weights, outputs)?;
        open.has_bias = true;
        Ok(axes)
    }

    /// `Relu` after the open layer.
    pub(super) fn rectify(&mut self, node: &Node, axes: Vec<Axis>) -> Result<Vec<Axis>, OnnxError> {
        let Some(open) = &self.open else {
            return Err(node_error(node, "place", "ReLU", "only after a convolution or a dense layer"));
        };
        if open.is_dense && open.kernel > 1 && self.padding == Some(Padding::Same) {
            let expected = "'valid' convolutions before a dense layer with ReLU, which becomes a convolution";
            return Err(node_error(
                node,
                "place",
                format!("ReLU after `{}` over 'same' convolutions", open.node),
                expected,
            ));
        }
        if open.is_dense && open.kernel > 1 {
            self.padding = Some(Padding::Valid);
        }
        self.close();
        Ok(axes)
    }

    /// Ends the network: the open dense layer is its head.
    pub(super) fn finish(mut self) -> Result<(Network, Layout), OnnxError> {
        let wrong = |found: &str| OnnxError::Model {
            what: "end of the graph",
            found: found.to_owned(),
            expected: "a dense layer without activation after at least one convolution".to_owned(),
        };
        let Some((layout, columns, inputs)) = self.layout else { return Err(wrong("no convolution")) };
        match self.open.take() {
            Some(open) if open.is_dense => {
                let outputs = open.layer.biases.len();
                self.layers.push(open.layer);
                let padding = self.padding.unwrap_or(Padding::Valid);
                let shape = Shape { columns, inputs, padding, convolutions: self.convolutions, outputs };
                Ok((Network::new(shape, self.layers)?, layout))
            }
            Some(open) => Err(wrong(&format!("`{}` ({})", open.node, open.operator))),
            None => Err(wrong("ReLU")),
        }
    }
}

/// Refuses strides, dilations and groups other than 1.
fn check_plain_convolution(node: &Node, spatial: usize) -> Result<(), OnnxError> {
    let expected = vec![1; spatial];
    for what in ["strides", "dilations"] {
        if let Some(found) = attribute(node, what).filter(|found| found.ints != expected) {
            return Err(node_error(node, what, format!("{:?}", found.ints), format!("{expected:?}")));
        }
    }
    match integer(node, "group", 1) {
        1 => Ok(()),
        groups => Err(node_error(node, "group", groups, 1)),
    }
}

/// Outputs and kernel length from the sizes of a convolution's weights. The input has `spatial`
/// axes besides batch and channels, and its columns are on axis `place`.
fn kernel_sizes(
    node: &Node,
    sizes: &[usize],
    (spatial, channels, place): (usize, usize, usize),
) -> Result<(usize, usize), OnnxError> {
    let found = match *sizes {
        [outputs, inputs, kernel] if spatial == 1 && inputs == channels => Some((outputs, kernel)),
        [outputs, inputs, 1, kernel] if spatial == 2 && inputs == channels && place == 3 => {
            Some((outputs, kernel))
        }
        [outputs, inputs, kernel, 1] if spatial == 2 && inputs == channels && place == 2 => {
            Some((outputs, kernel))
        }
        _ => None,
    };
    let is_allowed = |size: &usize| (1..=MAX_SIZE).contains(size);
    found.filter(|(outputs, kernel)| is_allowed(outputs) && is_allowed(kernel)).ok_or_else(|| {
        let expected = format!("outputs x {channels} x kernel, kernel size 1 on all axes except the columns");
        node_error(node, "sizes of the weights", format!("{sizes:?}"), expected)
    })
}
