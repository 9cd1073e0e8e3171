//! Why a model image was refused.

use core::fmt;

/// Layer of a network, for messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LayerName {
    /// First, second or third convolution (0, 1, 2) of the collision network.
    CollisionConvolution(u8),
    /// Dense head of the collision network.
    CollisionHead,
    /// First, second or third convolution (0, 1, 2) of the friction network.
    FrictionConvolution(u8),
    /// Dense head of the friction network.
    FrictionHead,
}

impl fmt::Display for LayerName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::CollisionConvolution(index) => write!(f, "collision convolution {index}"),
            Self::CollisionHead => f.write_str("collision head"),
            Self::FrictionConvolution(index) => write!(f, "friction convolution {index}"),
            Self::FrictionHead => f.write_str("friction head"),
        }
    }
}

/// Why an image was refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ImageError {
    /// The image does not have the one length of its format.
    Length {
        /// Bytes found.
        found: usize,
        /// Bytes expected.
        expected: usize,
    },
    /// The first eight bytes are not those of a model image.
    Magic,
    /// The format version is not the one this code reads.
    Version {
        /// Version found.
        found: u16,
        /// Version expected.
        expected: u16,
    },
    /// The length written in the header is not the image's.
    DeclaredLength {
        /// Length in the header.
        found: u32,
        /// Length of the image.
        expected: u32,
    },
    /// The check sum over the image differs from the one at its end.
    Crc {
        /// Check sum of the bytes.
        found: u32,
        /// Check sum at the end of the image.
        expected: u32,
    },
    /// No bearing has this code.
    Bearing {
        /// Code found.
        found: u8,
    },
    /// A network's shape is not the one this code runs.
    Shape {
        /// Name of the network.
        network: &'static str,
        /// Inputs, channels, kernel and head columns found.
        found: [u8; 4],
        /// Inputs, channels, kernel and head columns expected.
        expected: [u8; 4],
    },
    /// A number of the header is not finite or not in order.
    Field {
        /// Name of the field.
        name: &'static str,
    },
    /// A layer's 32-bit accumulator could overflow, or its multiplier is not above 0.
    Layer {
        /// The layer.
        layer: LayerName,
        /// Largest magnitude that its accumulator can reach; 0 if the multiplier or scale is at fault.
        largest_accumulator: i64,
    },
}

impl fmt::Display for ImageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length { found, expected } => {
                write!(f, "model image: found {found} bytes, expected {expected}")
            }
            Self::Magic => f.write_str("model image: the first bytes are not those of a model image"),
            Self::Version { found, expected } => {
                write!(f, "model image: found format version {found}, expected {expected}")
            }
            Self::DeclaredLength { found, expected } => {
                write!(f, "model image: header says {found} bytes, expected {expected}")
            }
            Self::Crc { found, expected } => {
                write!(f, "model image: check sum is {found:#010x}, expected {expected:#010x}")
            }
            Self::Bearing { found } => write!(f, "model image: found bearing code {found}, expected 0 or 1"),
            Self::Shape { network, found, expected } => write!(
                f,
                "model image: {network} network has shape {found:?} (inputs, channels, kernel, head columns), \
                 expected {expected:?}"
            ),
            Self::Field { name } => write!(f, "model image: {name} is not finite or not in order"),
            Self::Layer { layer, largest_accumulator: 0 } => {
                write!(f, "model image: {layer} has a multiplier or scale that is not above 0")
            }
            Self::Layer { layer, largest_accumulator } => {
                write!(
                    f,
                    "model image: accumulator of {layer} can reach {largest_accumulator}, expected below 2^31"
                )
            }
        }
    }
}

impl core::error::Error for ImageError {}
