//! Shapes of the supported networks: 1-D convolutions with ReLU over a window of columns, then one
//! dense layer.
//!
//! The dense layer is called the head. Its input is the output of the last convolution, flattened
//! as length x channel. It has no activation function.

use serde::{Deserialize, Serialize};

/// Padding at the ends of a window.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Padding {
    /// None: only positions where the kernel fits. The window gets shorter by `kernel - 1`.
    Valid,
    /// Zeros, so that the length does not change: `(kernel - 1) / 2` rounded down before the oldest
    /// column, the others after the newest.
    Same,
}

impl Padding {
    /// Name in messages.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Valid => "'valid'",
            Self::Same => "'same'",
        }
    }
}

/// One convolution.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ConvolutionShape {
    /// Length of the kernel in columns.
    pub kernel: usize,
    /// Output channels.
    pub outputs: usize,
}

/// Shape of a complete network.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shape {
    /// Columns of a window.
    pub columns: usize,
    /// Values of a column.
    pub inputs: usize,
    /// Padding of every convolution.
    pub padding: Padding,
    /// The convolutions, each followed by ReLU.
    pub convolutions: Vec<ConvolutionShape>,
    /// Outputs of the head.
    pub outputs: usize,
}

/// Maximum number of columns, channels or outputs.
pub const MAX_SIZE: usize = 4096;

/// Reason why a shape or a set of parameters is not a network.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ShapeError {
    /// A size of 0 or above [`MAX_SIZE`].
    #[error("network: {what} is {found}, expected 1 to {MAX_SIZE}")]
    Size {
        /// Name of the size.
        what: String,
        /// The size.
        found: usize,
    },
    /// A kernel is longer than its input.
    #[error("network: convolution {layer}: kernel is {kernel}, expected at most the {columns} columns left")]
    Kernel {
        /// Index of the convolution.
        layer: usize,
        /// Its kernel.
        kernel: usize,
        /// Input columns of the convolution.
        columns: usize,
    },
    /// The number of parameters differs from the shape.
    #[error("network: layer {layer}: found {found} {what}, expected {expected}")]
    Parameters {
        /// Index of the layer, the head last; the number of layers if that number is wrong.
        layer: usize,
        /// Kind of parameter.
        what: &'static str,
        /// Number found.
        found: usize,
        /// Number in the shape.
        expected: usize,
    },
}

/// Sizes of one layer. The head is a convolution over all its columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LayerSize {
    /// Input columns, without padding.
    pub columns: usize,
    /// Input channels.
    pub inputs: usize,
    /// Length of the kernel in columns.
    pub kernel: usize,
    /// Output channels.
    pub outputs: usize,
    /// Zero columns before the oldest column.
    pub before: usize,
    /// Output columns.
    pub positions: usize,
}

impl LayerSize {
    /// Number of weights of one output.
    pub(crate) const fn taps(&self) -> usize {
        self.kernel * self.inputs
    }

    /// Number of weights.
    pub(crate) const fn weights(&self) -> usize {
        self.taps() * self.outputs
    }
}

impl Shape {
    /// Sizes of all layers, the head last.
    pub fn layers(&self) -> Vec<LayerSize> {
        let (mut columns, mut inputs) = (self.columns, self.inputs);
        let mut layers = Vec::with_capacity(self.convolutions.len() + 1);
        for convolution in &self.convolutions {
            let shorter = convolution.kernel.saturating_sub(1);
            let (before, positions) = match self.padding {
                Padding::Valid => (0, columns.saturating_sub(shorter)),
                Padding::Same => (shorter / 2, columns),
            };
            let (kernel, outputs) = (convolution.kernel, convolution.outputs);
            layers.push(LayerSize { columns, inputs, kernel, outputs, before, positions });
            (columns, inputs) = (positions, outputs);
        }
        layers.push(LayerSize {
            columns,
            inputs,
            kernel: columns,
            outputs: self.outputs,
            before: 0,
            positions: 1,
        });
        layers
    }

    /// Checks every size.
    ///
    /// # Errors
    ///
    /// A size of 0 or above [`MAX_SIZE`], or a kernel longer than its input.
    pub(crate) fn check(&self) -> Result<(), ShapeError> {
        let sizes = [("columns", self.columns), ("inputs", self.inputs), ("outputs", self.outputs)];
        let named = sizes.into_iter().map(|(what, size)| (what.to_owned(), size));
        let convolutions = self.convolutions.iter().enumerate().flat_map(|(layer, convolution)| {
            let name = |what: &str| format!("{what} of convolution {layer}");
            [(name("kernel"), convolution.kernel), (name("outputs"), convolution.outputs)]
        });
        if let Some((what, found)) =
            named.chain(convolutions).find(|(_, size)| !(1..=MAX_SIZE).contains(size))
        {
            return Err(ShapeError::Size { what, found });
        }
        match self
            .layers()
            .iter()
            .enumerate()
            .find(|(_, layer)| layer.kernel > layer.columns || layer.kernel == 0)
        {
            Some((layer, size)) => {
                Err(ShapeError::Kernel { layer, kernel: size.kernel, columns: size.columns })
            }
            None => Ok(()),
        }
    }

    /// Number of weights and biases.
    pub(crate) fn parameters(&self) -> usize {
        self.layers().iter().map(|layer| layer.weights() + layer.outputs).sum()
    }

    /// Multiply-accumulates of a complete window.
    pub(crate) fn macs(&self) -> usize {
        self.layers().iter().map(|layer| layer.weights() * layer.positions).sum()
    }

    /// Multiply-accumulates of one new column if earlier results are reused.
    pub(crate) fn macs_per_step(&self) -> usize {
        self.layers().iter().map(LayerSize::weights).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reference() -> Shape {
        let convolution = |kernel, outputs| ConvolutionShape { kernel, outputs };
        Shape {
            columns: 32,
            inputs: 6,
            padding: Padding::Same,
            convolutions: vec![convolution(5, 16), convolution(5, 32), convolution(3, 32)],
            outputs: 1,
        }
    }

    #[test]
    fn counts_of_the_reference_network() {
        assert_eq!(reference().macs(), 196_608);
        assert_eq!(reference().parameters(), 480 + 16 + 2560 + 32 + 3072 + 32 + 1024 + 1);
        assert_eq!(reference().check(), Ok(()));
    }

    #[test]
    fn invalid_sizes_are_refused_by_name() {
        let mut shape = reference();
        shape.padding = Padding::Valid;
        shape.columns = 8;
        assert_eq!(shape.check(), Err(ShapeError::Kernel { layer: 1, kernel: 5, columns: 4 }));
        shape.convolutions[1].outputs = 0;
        let expected = ShapeError::Size { what: "outputs of convolution 1".into(), found: 0 };
        assert_eq!(shape.check(), Err(expected));
    }
}
