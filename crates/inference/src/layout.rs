//! Shapes and byte offsets of a model image: the one place that knows them.
//!
//! Little-endian, no padding, no alignment, no pointers: an image may lie anywhere.
//!
//! | bytes | what |
//! |---|---|
//! | 0..8 | magic |
//! | 8..10 | format version |
//! | 10 | bearing code |
//! | 11 | half powers of the deformation in the collision target (0, 1, 2) |
//! | 12..16 | length of the image |
//! | 16..24 | training id |
//! | 24..84 | fifteen f32: training ranges (low, high) of radial clearance, deformation, rate ratio, sliding speed, normal force; latch floor; two speed scales; two reserved |
//! | 84..88 | collision network: inputs, channels, kernel, head columns |
//! | 88..92 | friction network: the same |
//! | then | collision network, friction network |
//! | last 4 | CRC-32 (ISO-HDLC) of everything before |
//!
//! A network is three convolutions and a head. A convolution is 16 i32 biases, 16 i32 multipliers (the real factor
//! times 2^32) and its i8 weights, interleaved by four output channels: `[block of 4 outputs][tap x input][output in
//! block]`. A head is one f32 scale, one i32 bias and its i8 weights `[column][channel]`, oldest column first.

/// Magic of a model image.
pub const MAGIC: [u8; 8] = *b"PINTLEM\n";
/// Version of the format.
pub const FORMAT_VERSION: u16 = 1;

/// Channels of every convolution.
pub const CHANNELS: usize = 16;
/// Columns that a convolution looks at.
pub const KERNEL: usize = 3;
/// Convolutions of a network.
pub const CONVOLUTIONS: usize = 3;
/// Columns of the last convolution that the head looks at.
pub const HEAD_COLUMNS: usize = 2;
/// Output channels computed together.
pub const BLOCK: usize = 4;
/// Blocks of output channels in a convolution.
pub const BLOCKS: usize = CHANNELS / BLOCK;
/// Input columns that one output depends on.
pub const WINDOW: usize = CONVOLUTIONS * (KERNEL - 1) + HEAD_COLUMNS;

/// Inputs of the collision network per column.
pub const COLLISION_INPUTS: usize = 8;
/// Inputs of the friction network per column.
pub const FRICTION_INPUTS: usize = 4;
/// Taps of a first convolution of the collision network.
pub const COLLISION_TAPS: usize = KERNEL * COLLISION_INPUTS;
/// Taps of a first convolution of the friction network.
pub const FRICTION_TAPS: usize = KERNEL * FRICTION_INPUTS;
/// Taps of the second and third convolutions.
pub const HIDDEN_TAPS: usize = KERNEL * CHANNELS;
/// Weights of a head.
pub const HEAD_WEIGHTS: usize = HEAD_COLUMNS * CHANNELS;

/// Bytes of the header.
pub const HEADER_LENGTH: usize = 92;
/// Bytes of the check sum.
pub const CRC_LENGTH: usize = 4;

/// Bytes of a convolution with so many taps.
pub const fn convolution_length(taps: usize) -> usize {
    CHANNELS * (8 + taps)
}

/// Bytes of a network whose first convolution has so many taps.
pub const fn network_length(first_taps: usize) -> usize {
    convolution_length(first_taps) + 2 * convolution_length(HIDDEN_TAPS) + 8 + HEAD_WEIGHTS
}

/// Bytes of an image.
pub const IMAGE_LENGTH: usize =
    HEADER_LENGTH + network_length(COLLISION_TAPS) + network_length(FRICTION_TAPS) + CRC_LENGTH;

/// Multiply-accumulates of one streaming step of a network whose first convolution has so many taps.
pub const fn macs_per_step(first_taps: usize) -> usize {
    CHANNELS * (first_taps + 2 * HIDDEN_TAPS) + HEAD_WEIGHTS
}

static CRC: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);

/// CRC-32 (ISO-HDLC, as in zlib) of some bytes.
pub fn check_sum(bytes: &[u8]) -> u32 {
    CRC.checksum(bytes)
}
