//! Frames between the host and the controller: the one place that knows the wire format.
//!
//! A frame is one message in postcard's encoding, its CRC-32 (ISO-HDLC, little endian) behind it, the whole COBS-stuffed
//! and closed by one zero byte. The zero appears nowhere else, so a receiver that lost its place finds the next
//! frame by itself; the CRC refuses what was damaged on the way.
//!
//! The host sends [`ToController`], the controller [`ToHost`]. Samples go in lockstep: one [`SensorFrame`] out, one
//! [`NumberedEstimate`] (or a [`Fault`]) back. The sensor frame's time is the controller's time. Lengths travel
//! in nanometres and angles in nanoradians, as integers, so that nothing is lost between sensor and conditioning.
//! Commands are numbered and acknowledged (see [`Command`]); estimates and slow telemetry have a number of their own each, so
//! that either side knows what it has missed.
//!
//! Limits: a frame is at most [`MAX_FRAME`] bytes long; CRC-32 misses one damaged frame in four thousand million. Nothing
//! here authenticates the other side.
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]

mod check_sum;
mod configuration;
mod counters;
mod decode;
mod encode;
mod hello;
mod message;
mod sample;
pub mod start;
pub mod track;
pub mod update;
mod wiring;

pub use check_sum::crc32;
pub use configuration::{
    CONFIGURATION_VERSION, Calibration, Configuration, Configured, ControllerConfiguration, Field, Limits,
    MAX_REASONS, OutOfRange, Reasons, Refusal,
};
pub use counters::{Counters, LineErrors};
pub use decode::{BadFrames, Decoder, FrameError};
pub use encode::{ESTIMATE_FRAME, EncodeError, encode, encode_estimate};
pub use hello::{BUILD_ID_LEN, BuildId, ClockSource, Hello, MAGIC, ModelId, PROTOCOL_VERSION, Target};
pub use message::{
    Acknowledgement, Answer, Command, Fault, NumberedCommand, Refused, ReportKind, SlowFrame, SlowReport,
    State, ToController, ToHost,
};
pub use sample::{EstimateFrame, EstimateLayout, NumberedEstimate, SensorFrame};
pub use wiring::{InputRange, Wiring, WiringField};

/// Longest frame on the wire, in bytes, delimiter included.
pub const MAX_FRAME: usize = 255;

/// Longest message with its CRC, in bytes: a frame less the stuffing byte and the delimiter.
///
/// Below 254, so COBS adds exactly one byte.
pub const MAX_PAYLOAD: usize = MAX_FRAME - 2;

/// Closes every frame.
pub const DELIMITER: u8 = 0;
