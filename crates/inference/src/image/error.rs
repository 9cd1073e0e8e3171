//! Reasons for refusing a model image.

use super::{LayerName, LayerShape};
use contact::BearingMaterial;
use core::fmt;

/// Reason for refusing a model image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageError {
    /// The image ends before its networks do.
    TooShort,
    /// The image is not as long as its header says.
    Length {
        /// Bytes found.
        found: usize,
        /// Bytes that the header declares.
        expected: u32,
    },
    /// The image does not lie at an address divisible by 4.
    Alignment,
    /// The first eight bytes are not those of a model image.
    Magic,
    /// The format version is not the one that this code reads.
    Version {
        /// Version found.
        found: u16,
        /// Version expected.
        expected: u16,
    },
    /// The checksum over the image differs from the one at its end.
    Crc {
        /// Checksum of the bytes.
        found: u32,
        /// Checksum at the end of the image.
        expected: u32,
    },
    /// No bearing has this code.
    Bearing {
        /// Code found.
        found: u8,
    },
    /// A header field is out of its range.
    Field {
        /// Name of the field and its unit.
        name: &'static str,
        /// Number found.
        found: u32,
        /// Smallest and largest number expected.
        expected: [u32; 2],
    },
    /// A layer's shape does not match the model's type.
    Shape {
        /// The layer.
        layer: LayerName,
        /// Shape found; `None` if the bytes are not a shape.
        found: Option<LayerShape>,
        /// Shape expected, in the storage form that was found.
        expected: LayerShape,
    },
    /// A layer's 32-bit sum can overflow.
    Overflow {
        /// The layer.
        layer: LayerName,
        /// Output channel.
        output: u16,
        /// Largest magnitude that the sum can reach.
        largest: i64,
    },
    /// A layer's multiplier is not above 0, or its shift is out of range.
    Scale {
        /// The layer.
        layer: LayerName,
    },
    /// Bytes follow the last layer.
    Trailing,
}

impl ImageError {
    /// Cause of an image whose CRC-32 is wrong.
    pub const CRC: u8 = 4;
    /// Cause of a bearing code that no material has.
    pub const BEARING: u8 = 5;

    /// Returns the reason as one byte for compact reports. The codes never change; new reasons get
    /// new codes.
    pub const fn cause(&self) -> u8 {
        match self {
            Self::Length { .. } => 0,
            Self::Magic => 1,
            Self::Version { .. } => 2,
            Self::TooShort => 3,
            Self::Crc { .. } => Self::CRC,
            Self::Bearing { .. } => Self::BEARING,
            Self::Shape { .. } => 6,
            Self::Field { .. } => 7,
            Self::Overflow { .. } => 8,
            Self::Scale { .. } => 9,
            Self::Alignment => 10,
            Self::Trailing => 11,
        }
    }
}

impl fmt::Display for ImageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("model image: ")?;
        match self {
            Self::TooShort => f.write_str("it ends before its networks do"),
            Self::Length { found, expected } => {
                write!(f, "found {found} bytes, its header declares {expected}")
            }
            Self::Alignment => f.write_str("its address is not divisible by 4"),
            Self::Magic => f.write_str("the first bytes are not those of a model image"),
            Self::Version { found, expected } => {
                write!(f, "found format version {found}, expected {expected}")
            }
            Self::Crc { found, expected } => {
                write!(f, "found checksum {found:#010x}, expected {expected:#010x} as at its end")
            }
            Self::Bearing { found } => {
                write!(f, "found bearing code {found}, expected below {}", BearingMaterial::COUNT)
            }
            Self::Field { name, found, expected: [low, high] } => {
                write!(f, "{name}: found {found}, expected {low} to {high}")
            }
            Self::Shape { layer, found: Some(found), expected } => {
                write!(f, "{layer} is {found}, expected {expected}")
            }
            Self::Shape { layer, found: None, expected } => {
                write!(f, "{layer} has no valid shape, expected {expected}")
            }
            Self::Overflow { layer, output, largest } => {
                write!(f, "sum of output {output} in {layer} can reach {largest}, expected below 2^31")
            }
            Self::Scale { layer } => {
                write!(f, "{layer} has a multiplier that is not above 0 or a shift out of range")
            }
            Self::Trailing => f.write_str("something follows the last layer"),
        }
    }
}

impl core::error::Error for ImageError {}
