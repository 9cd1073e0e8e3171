//! Model image: one blob of bytes that is checked once and then read in place.
//!
//! Little-endian, no pointers, any address divisible by 4. Every number in it is an integer, so
//! that loading and running need no floating point.
//!
//! | bytes | content |
//! |---|---|
//! | 0..8 | magic |
//! | 8..10 | format version |
//! | 10 | bearing code |
//! | 11 | half powers of the deformation in the collision target (0, 1, 2) |
//! | 12..16 | length of the image |
//! | 16..24 | training id |
//! | 24..60 | nine u32 of the [`Header`]: ranges, floor, speed scales |
//! | 60..64 | reserved, 0 |
//! | then | layers of the collision network, layers of the friction network |
//! | last 4 | CRC-32 (ISO-HDLC) of everything before |
//!
//! A layer is its [`LayerShape`] (12 bytes), then
//!
//! * a convolution: per output an i32 bias, the weights, an i32 multiplier (the real factor times
//!   2^32);
//! * a head: i32 multiplier and u32 shift of its scale (multiplier / 2^shift), one i32 bias per
//!   output, the weights.
//!
//! Every group of weights takes four bytes. Outputs are stored in blocks of four, the rest one by
//! one; [`crate::storage`] defines the order.

mod error;
mod header;
mod layers;
mod name;
mod proof;
mod reader;
mod shape;
pub mod write;

pub use error::ImageError;
pub use header::{Header, Range};
pub use layers::{ReadLayers, load_layers};
pub use name::LayerName;
pub use proof::{Unproven, prove};
pub use reader::Reader;
pub use shape::{LayerKind, LayerShape, WeightForm};

/// Magic of a model image.
pub const MAGIC: [u8; 8] = *b"PINTLEM\n";
/// Version of the format.
pub const FORMAT_VERSION: u16 = 3;
/// Bytes of the header.
pub const HEADER_LENGTH: usize = 64;
/// Bytes of a layer's shape.
pub const SHAPE_LENGTH: usize = 12;
/// Bytes of the checksum.
pub const CRC_LENGTH: usize = 4;

static CRC: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);

/// Returns the CRC-32 (ISO-HDLC, as in zlib) of some bytes.
pub fn checksum(bytes: &[u8]) -> u32 {
    CRC.checksum(bytes)
}

const _: () = assert!(cfg!(target_endian = "little"), "images are read in place, lowest byte first");
