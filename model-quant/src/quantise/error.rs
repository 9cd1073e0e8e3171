//! Reasons why a network cannot be quantised.

use inference::ImageError;
use inference::image::write::WriteError;

/// Reason why a network cannot be quantised.
#[derive(Debug, thiserror::Error)]
pub enum QuantiseError {
    /// The factor between two scales does not fit into 32 bits: weights and activations are
    /// inconsistent.
    #[error(
        "layer {layer}, channel {channel}: factor between the scales is {factor:e}, expected 2^-32 to 0.5"
    )]
    Factor {
        /// Index of the layer.
        layer: usize,
        /// Output channel.
        channel: usize,
        /// The factor.
        factor: f64,
    },
    /// A weight scaled by its input, or an activation, exceeds the range of f32.
    #[error("layer {layer}: {what} exceed the range of f32, expected finite values")]
    Infinite {
        /// Index of the layer.
        layer: usize,
        /// Weights or activations.
        what: &'static str,
    },
    /// A size of a layer exceeds its field in the image.
    #[error("layer {layer}: {what}: found {size}, which exceeds the field of the image")]
    Size {
        /// Index of the layer.
        layer: usize,
        /// Name of the size.
        what: &'static str,
        /// The size.
        size: usize,
    },
    /// The generated image was refused by the inference engine.
    #[error("{0}")]
    Image(#[from] ImageError),
    /// The image could not be written.
    #[error("{0}")]
    Write(#[from] WriteError),
}
