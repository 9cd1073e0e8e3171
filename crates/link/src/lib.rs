//! Frames between the host and the controller: the only place that defines the wire format.
//!
//! A frame is one message in postcard's encoding, followed by its CRC-32 (ISO-HDLC, little endian).
//! COBS removes all zeros from it, and one zero byte ends it. The zero appears nowhere else, so a
//! receiver that lost its place finds the next frame. The CRC rejects damaged frames.
//!
//! The host sends [`ToController`], the controller sends [`ToHost`]. In lockstep the host sends one
//! [`SensorFrame`] and receives one [`NumberedEstimate`] (or a [`Fault`]). A controller that reads
//! its own sensors sends its estimates without being asked. The time in a sensor frame is the
//! controller's time. Lengths travel as integer nanometres and angles as integer nanoradians, so
//! nothing is lost between sensor and estimator. Commands are numbered and acknowledged (see
//! [`Command`]). Estimates and slow telemetry are numbered separately, so each side knows what it
//! missed.
//!
//! Limits: a frame has at most [`MAX_FRAME`] bytes, and CRC-32 misses one damaged frame in four
//! thousand million. Commands are authenticated if the firmware has a key ([`authentication`]).
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]

pub mod authentication;
mod configuration;
mod counters;
pub mod crc32;
mod decode;
mod encode;
mod hello;
mod impact;
mod message;
mod sample;
mod sampling;
pub mod start;
pub mod track;
pub mod update;
mod wiring;

pub use configuration::{
    BenchConfiguration, CONFIGURATION_VERSION, Calibration, Configured, ContactSource,
    ControllerConfiguration, Field, Limits, MAX_REASONS, OutOfRange, Reasons,
};
pub use counters::{Counters, LineErrors};
pub use crc32::crc32;
pub use decode::{BadFrames, Decoder, FrameError};
pub use encode::{ESTIMATE_FRAME, EncodeError, encode, encode_estimate};
pub use hello::{
    BUILD_ID_LEN, BuildId, ClockSource, Hello, MAGIC, MODELS, ModelId, PROTOCOL_VERSION, State, Target,
};
pub use impact::{BlockSummary, ImpactEnd, ImpactRecord};
pub use message::{
    Acknowledgement, Answer, Command, Fault, NumberedCommand, Refusal, ReportKind, SlowFrame, SlowReport,
    ToController, ToHost,
};
pub use sample::{EstimateFrame, EstimateLayout, NumberedEstimate, SensorFrame, VALUES};
pub use sampling::SamplingReport;
pub use wiring::{InputRange, Wiring, WiringField};

/// Compiles the examples of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;

/// Maximum length of a frame on the wire, in bytes, delimiter included.
pub const MAX_FRAME: usize = 255;

/// Maximum length of a message with its CRC, in bytes: a frame less the stuffing byte and the
/// delimiter.
///
/// It is below 254, so COBS adds exactly one byte.
pub const MAX_PAYLOAD: usize = MAX_FRAME - 2;

/// Byte that ends every frame.
pub const DELIMITER: u8 = 0;
