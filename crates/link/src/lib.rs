//! Frames between the host and the controller: the one place that knows the wire format.
//!
//! A frame is one message in postcard's encoding, its CRC-32 (ISO-HDLC, little endian) behind it, the whole COBS-stuffed
//! and closed by one zero byte. The zero appears nowhere else, so a receiver that lost its place finds the next
//! frame by itself; the CRC refuses what was damaged on the way.
//!
//! The host sends [`ToController`], the controller [`ToHost`]. The exchange is lockstep: one [`SensorFrame`] out, one
//! [`EstimateFrame`] (or a [`Fault`]) back. The sensor frame's time is the controller's time. Lengths travel
//! in nanometres and angles in nanoradians, as integers, so that nothing is lost between sensor and conditioning.
//!
//! Limits: a frame is at most [`MAX_FRAME`] bytes long; CRC-32 misses one damaged frame in four thousand million. Nothing
//! here authenticates the other side.
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]

mod decode;
mod encode;
mod message;
pub mod start;
pub mod track;

pub use decode::{BadFrames, Decoder, FrameError};
pub use encode::{EncodeError, encode};
pub use message::{
    BUILD_ID_LEN, BuildId, ClockSource, Configuration, Configured, Counters, EstimateFrame, Fault, Hello,
    MAGIC, ModelId, PROTOCOL_VERSION, Refusal, SensorFrame, Target, ToController, ToHost,
};

/// Longest frame on the wire, in bytes, delimiter included. The longest message (a [`Hello`]) needs about half of it.
pub const MAX_FRAME: usize = 192;

/// Longest message with its CRC, in bytes: a frame less the stuffing byte and the delimiter.
///
/// Below 254, so COBS adds exactly one byte.
pub const MAX_PAYLOAD: usize = MAX_FRAME - 2;

/// Closes every frame.
pub const DELIMITER: u8 = 0;

static CRC: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
