//! Sample inputs and outputs of a network for its check and calibration: a safetensors file with
//! two f32 tensors.
//!
//! | tensor | axes |
//! |---|---|
//! | `inputs` | samples x the two axes after the batch, in the order of the network's file |
//! | `outputs` | samples x outputs of the framework |
//!
//! Written in Python by `safetensors.numpy.save_file({"inputs": x, "outputs": y}, path)`, or
//! `safetensors.torch`.

use super::layout::Layout;
use super::weight_order::transposed;
use crate::network::{Network, Shape};
use safetensors::{Dtype, SafeTensorError, SafeTensors, tensor::TensorView};

/// Reason why samples were refused.
#[derive(Debug, thiserror::Error)]
pub enum SamplesError {
    /// The bytes are not a safetensors file.
    #[error("no safetensors file, or a damaged one: {0}")]
    File(#[from] SafeTensorError),
    /// A tensor does not match the network.
    #[error("tensor `{tensor}`: {what}: found {found}, expected {expected}")]
    Tensor {
        /// Name of the tensor.
        tensor: &'static str,
        /// Type, axes or the like.
        what: &'static str,
        /// Content found.
        found: String,
        /// Content expected.
        expected: String,
    },
}

/// Windows with the outputs of the network.
#[derive(Clone, Debug, PartialEq)]
pub struct Samples {
    /// Columns oldest first, flattened.
    pub windows: Vec<Vec<f32>>,
    /// Outputs.
    pub outputs: Vec<Vec<f32>>,
}

/// Largest difference of a network from its samples.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Difference {
    /// Absolute difference.
    pub largest: f64,
    /// Index of the sample with the largest difference.
    pub sample: usize,
    /// Index of that output.
    pub output: usize,
    /// Largest magnitude of an output in the samples.
    pub full_scale: f64,
}

impl Difference {
    /// Largest difference divided by the full scale.
    pub fn relative(&self) -> f64 {
        if self.largest == 0.0 { 0.0 } else { self.largest / self.full_scale }
    }
}

impl Samples {
    /// Decodes the samples of a network whose file has this layout.
    ///
    /// # Errors
    ///
    /// A file of another kind, tensors of other types or sizes, or non-finite numbers.
    pub fn read(bytes: &[u8], shape: &Shape, layout: Layout) -> Result<Self, SamplesError> {
        let file = SafeTensors::deserialize(bytes)?;
        let window = axes(shape, layout);
        let (count, inputs) = values(&file, "inputs", None, &window)?;
        let (_, outputs) = values(&file, "outputs", Some(count), &[shape.outputs])?;
        let size = shape.columns * shape.inputs;
        let windows = inputs.chunks_exact(size).map(|values| columns_first(values, shape, layout)).collect();
        Ok(Self { windows, outputs: outputs.chunks_exact(shape.outputs).map(<[f32]>::to_vec).collect() })
    }

    /// Encodes a file.
    ///
    /// # Errors
    ///
    /// Those of the safetensors writer.
    pub fn to_bytes(&self, shape: &Shape, layout: Layout) -> Result<Vec<u8>, SafeTensorError> {
        let ordered = self.windows.iter().flat_map(|window| from_columns_first(window, shape, layout));
        let inputs: Vec<u8> = ordered.flat_map(f32::to_le_bytes).collect();
        let outputs: Vec<u8> = self.outputs.iter().flatten().flat_map(|value| value.to_le_bytes()).collect();
        let [first, second] = axes(shape, layout);
        let view = |sizes: Vec<usize>, bytes| TensorView::new(Dtype::F32, sizes, bytes);
        let tensors = [
            ("inputs", view(vec![self.windows.len(), first, second], &inputs)?),
            ("outputs", view(vec![self.outputs.len(), shape.outputs], &outputs)?),
        ];
        safetensors::serialize(tensors, None)
    }

    /// Largest difference of a network from the outputs.
    pub fn difference(&self, network: &Network) -> Difference {
        let full_scale =
            self.outputs.iter().flatten().fold(0.0_f64, |largest, value| largest.max(f64::from(value.abs())));
        let mut found = Difference { largest: 0.0, sample: 0, output: 0, full_scale };
        for (sample, (window, outputs)) in self.windows.iter().zip(&self.outputs).enumerate() {
            for (output, (ours, theirs)) in network.evaluate(window).iter().zip(outputs).enumerate() {
                let difference = (f64::from(*ours) - f64::from(*theirs)).abs();
                if difference > found.largest || difference.is_nan() {
                    found = Difference { largest: difference, sample, output, full_scale };
                }
            }
        }
        found
    }
}

/// Sizes of the axes of a window in a file.
fn axes(shape: &Shape, layout: Layout) -> [usize; 2] {
    match layout {
        Layout::ColumnsFirst => [shape.columns, shape.inputs],
        Layout::ChannelsFirst => [shape.inputs, shape.columns],
    }
}

/// Reorders a window of a file to column by column.
fn columns_first(values: &[f32], shape: &Shape, layout: Layout) -> Vec<f32> {
    match layout {
        Layout::ColumnsFirst => values.to_vec(),
        Layout::ChannelsFirst => transposed(values, shape.columns),
    }
}

/// Reorders a window to the order of a file.
fn from_columns_first(window: &[f32], shape: &Shape, layout: Layout) -> Vec<f32> {
    match layout {
        Layout::ColumnsFirst => window.to_vec(),
        Layout::ChannelsFirst => transposed(window, shape.inputs),
    }
}

/// Values of an f32 tensor and the number of samples.
fn values(
    file: &SafeTensors<'_>,
    tensor: &'static str,
    samples: Option<usize>,
    window_axes: &[usize],
) -> Result<(usize, Vec<f32>), SamplesError> {
    let wrong = |what, found, expected: &str| SamplesError::Tensor {
        tensor,
        what,
        found,
        expected: expected.to_owned(),
    };
    let view = file.tensor(tensor).map_err(|_| {
        let names = file.names();
        wrong("presence", format!("only {names:?}"), "tensors `inputs` and `outputs`")
    })?;
    if view.dtype() != Dtype::F32 {
        return Err(wrong("type", format!("{:?}", view.dtype()), "F32"));
    }
    let count = match view.shape() {
        [count, rest @ ..]
            if rest == window_axes && *count > 0 && samples.is_none_or(|samples| samples == *count) =>
        {
            *count
        }
        found => {
            let samples = samples.map_or("samples".to_owned(), |samples| samples.to_string());
            let window_axes: Vec<String> = window_axes.iter().map(usize::to_string).collect();
            return Err(wrong(
                "axes",
                format!("{found:?}"),
                &format!("[{samples}, {}]", window_axes.join(", ")),
            ));
        }
    };
    let values: Vec<f32> =
        view.data().as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
    let of_a_sample = window_axes.iter().product::<usize>().max(1);
    match values.iter().position(|value| !value.is_finite()) {
        Some(place) => {
            let value = values.get(place).copied().unwrap_or_default();
            let found = format!("{value} at index {} of sample {}", place % of_a_sample, place / of_a_sample);
            Err(wrong("value", found, "finite numbers"))
        }
        None => Ok((count, values)),
    }
}
