//! The layers of a network while its graph is being followed.

use super::axes::{Axis, Meaning};
use super::constant::{Constants, attribute, biases, integer, number};
use super::error::{OnnxError, at, name};
use super::frameworks::{from_convolution, turned};
use super::padding::{named, padding};
use super::proto::Node;
use super::recognise::Layout;
use crate::network::{ConvolutionShape, LARGEST, Layer, Network, Padding, Shape};

/// The layer whose ReLU or end has not been seen.
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

/// What has been followed so far.
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

    /// Puts the open layer among the convolutions.
    fn close(&mut self) {
        if let Some(open) = self.open.take() {
            self.convolutions
                .push(ConvolutionShape { kernel: open.kernel, outputs: open.layer.biases.len() });
            self.layers.push(open.layer);
        }
    }

    /// Refuses a layer on top of one without ReLU.
    fn check_closed(&self, node: &Node) -> Result<(), OnnxError> {
        match &self.open {
            Some(open) => {
                let found = format!("{} behind `{}` ({})", node.op_type, open.node, open.operator);
                Err(at(node, "input", found, "ReLU between two layers"))
            }
            None => Ok(()),
        }
    }

    /// `Conv`: over batch x channels x columns, perhaps with an axis of size 1 beside the columns.
    pub(super) fn convolution(
        &mut self,
        node: &Node,
        constants: &Constants<'_>,
        axes: Vec<Axis>,
    ) -> Result<Vec<Axis>, OnnxError> {
        self.check_closed(node)?;
        let spatial = axes.len().saturating_sub(2);
        let all = |what: &str, expected: i64| match attribute(node, what) {
            Some(found) if found.ints != vec![expected; spatial] => {
                Err(at(node, what, format!("{:?}", found.ints), format!("{:?}", vec![expected; spatial])))
            }
            _ => Ok(()),
        };
        all("strides", 1)?;
        all("dilations", 1)?;
        let groups = integer(node, "group", 1);
        if groups != 1 {
            return Err(at(node, "group", groups, 1));
        }
        let (channels, columns, place) = self.orient(node, &axes)?;
        let weights = constants.weights(node, 1, "weights")?;
        let expected = || format!("outputs x {channels} x kernel, the kernel 1 beside the columns");
        let wrong = || at(node, "sizes of the weights", format!("{:?}", weights.sizes), expected());
        let (outputs, kernel) = match weights.sizes[..] {
            [outputs, inputs, kernel] if spatial == 1 && inputs == channels => (outputs, kernel),
            [outputs, inputs, 1, kernel] if spatial == 2 && inputs == channels && place == 3 => {
                (outputs, kernel)
            }
            [outputs, inputs, kernel, 1] if spatial == 2 && inputs == channels && place == 2 => {
                (outputs, kernel)
            }
            _ => return Err(wrong()),
        };
        if !(1..=LARGEST).contains(&outputs) || !(1..=LARGEST).contains(&kernel) {
            return Err(wrong());
        }
        let padding = padding(node, spatial, place, kernel)?;
        match (self.padding, padding) {
            (Some(before), Some(now)) if before != now => {
                let [found, expected] = [now, before].map(named);
                return Err(at(node, "pads", found, format!("{expected} as the convolutions before it")));
            }
            (None, now) => self.padding = now,
            _ => {}
        }
        let left = match self.padding {
            Some(Padding::Same) => columns,
            _ => (columns + 1).checked_sub(kernel).filter(|&left| left > 0).ok_or_else(|| {
                at(
                    node,
                    "kernel",
                    format!("{kernel} columns"),
                    format!("at most the {columns} that are left"),
                )
            })?,
        };
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

    /// Which axis has the columns: channels, columns and the place of the latter. The first convolution tells it for the input.
    fn orient(&mut self, node: &Node, axes: &[Axis]) -> Result<(usize, usize, usize), OnnxError> {
        let wrong = || {
            let found: Vec<String> =
                axes.iter().map(|axis| format!("{:?}", axis.meaning).to_lowercase()).collect();
            at(node, "axes of the input", found.join(" x "), "batch x channels x columns")
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

    /// `Gemm` or `MatMul` on a flattened value.
    pub(super) fn dense(
        &mut self,
        node: &Node,
        constants: &Constants<'_>,
        axes: Vec<Axis>,
    ) -> Result<Vec<Axis>, OnnxError> {
        self.check_closed(node)?;
        let (batch, axis) = match axes[..] {
            [batch @ Axis { meaning: Meaning::Batch, .. }, axis] if axis.meaning.is_flat() => (batch, axis),
            _ => return Err(at(node, "input", format!("{} axes", axes.len()), "batch x flattened values")),
        };
        let mut is_transposed = false;
        if node.op_type == "Gemm" {
            for (what, expected) in [("alpha", 1.0), ("beta", 1.0)] {
                let found = number(node, what, 1.0);
                if found != expected {
                    return Err(at(node, what, found, expected));
                }
            }
            if integer(node, "transA", 0) != 0 {
                return Err(at(node, "transA", integer(node, "transA", 0), 0));
            }
            is_transposed = integer(node, "transB", 0) != 0;
        }
        let weights = constants.weights(node, 1, "weights")?;
        let (taps, outputs) = match (&weights.sizes[..], is_transposed) {
            (&[taps, outputs], false) | (&[outputs, taps], true) => (taps, outputs),
            _ => return Err(at(node, "sizes of the weights", format!("{:?}", weights.sizes), "two axes")),
        };
        if taps != axis.size || !(1..=LARGEST).contains(&outputs) {
            let expected = format!("{} taps and 1 to {LARGEST} outputs", axis.size);
            return Err(at(node, "sizes of the weights", format!("{:?}", weights.sizes), expected));
        }
        let channels = self.layers.last().map_or(axis.size, |layer| layer.biases.len());
        let columns = axis.size / channels.max(1);
        let rows = if is_transposed { weights.values } else { turned(&weights.values, outputs) };
        let ours = match axis.meaning {
            Meaning::ByChannel => from_convolution(&rows, channels, columns, outputs),
            _ => turned(&rows, taps),
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
            return Err(at(node, "place", "Add", "only the bias of a convolution or a dense layer"));
        };
        let weights = constants.weights(node, place, "bias")?;
        let outputs = open.layer.biases.len();
        let is_along = |meaning| matches!(meaning, Meaning::Channels | Meaning::Dense);
        // The bias is aligned with the last axes; only that of the outputs may be wide.
        let fits = weights.sizes.len() <= axes.len()
            && weights
                .sizes
                .iter()
                .rev()
                .zip(axes.iter().rev())
                .all(|(&size, axis)| size == 1 || is_along(axis.meaning) && size == outputs);
        if !fits {
            let expected = format!("{outputs} values along the outputs");
            return Err(at(node, "sizes of the bias", format!("{:?}", weights.sizes), expected));
        }
        open.layer.biases = biases(node, &weights, outputs)?;
        open.has_bias = true;
        Ok(axes)
    }

    /// `Relu`: the open layer is one with ReLU behind it.
    pub(super) fn rectify(&mut self, node: &Node, axes: Vec<Axis>) -> Result<Vec<Axis>, OnnxError> {
        let Some(open) = &self.open else {
            return Err(at(node, "place", "ReLU", "only behind a convolution or a dense layer"));
        };
        if open.is_dense && open.kernel > 1 && self.padding == Some(Padding::Same) {
            let expected = "'valid' convolutions before a dense layer with ReLU, which becomes one itself";
            return Err(at(
                node,
                "place",
                format!("ReLU behind `{}` over 'same' convolutions", open.node),
                expected,
            ));
        }
        if open.is_dense && open.kernel > 1 {
            self.padding = Some(Padding::Valid);
        }
        self.close();
        Ok(axes)
    }

    /// The network: the open dense layer is its head.
    pub(super) fn finish(mut self) -> Result<(Network, Layout), OnnxError> {
        let wrong = |found: &str| OnnxError::Model {
            what: "end of the graph",
            found: found.to_owned(),
            expected: "a dense layer without activation behind at least one convolution".to_owned(),
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
