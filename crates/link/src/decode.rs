//! Incremental decoder of messages that accepts any bytes.
//!
//! Bytes enter one at a time. Each delimiter yields a message, or the reason why the bytes before
//! it are not a message. After a damaged frame the decoder is synchronous again at the next
//! delimiter. Rejected frames are counted by cause.

use cobs::{DecodeResult, DecoderState};
use heapless::Vec;
use serde::{Deserialize, Serialize, de::DeserializeOwned};

use crate::{MAGIC, MAX_PAYLOAD, PROTOCOL_VERSION, crc32};

/// Reason why the bytes up to a delimiter are not a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum FrameError {
    /// The stuffing does not end where the frame ends.
    Cobs,
    /// The checksum does not match.
    Crc,
    /// The frame is longer than the maximum.
    Overlong,
    /// The frame is intact but holds no message of this protocol.
    Unknown,
    /// The frame is an intact hello frame of another protocol version.
    OtherVersion {
        /// Version found.
        found: u8,
    },
}

impl core::fmt::Display for FrameError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Cobs => f.write_str("broken stuffing"),
            Self::Crc => f.write_str("checksum does not match"),
            Self::Overlong => write!(f, "longer than {MAX_PAYLOAD} bytes"),
            Self::Unknown => f.write_str("no message of this protocol"),
            Self::OtherVersion { found } => {
                write!(f, "protocol version {found}, expected {PROTOCOL_VERSION}")
            }
        }
    }
}

impl core::error::Error for FrameError {}

/// Rejected frames by cause. The counts saturate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct BadFrames {
    /// [`FrameError::Cobs`].
    pub cobs: u32,
    /// [`FrameError::Crc`].
    pub crc: u32,
    /// [`FrameError::Overlong`].
    pub overlong: u32,
    /// [`FrameError::Unknown`] and [`FrameError::OtherVersion`].
    pub unknown: u32,
}

impl BadFrames {
    /// Returns the sum over all causes.
    #[must_use]
    pub const fn total(&self) -> u32 {
        self.cobs.saturating_add(self.crc).saturating_add(self.overlong).saturating_add(self.unknown)
    }

    /// Counts one rejected frame.
    pub fn count(&mut self, error: FrameError) {
        let counter = match error {
            FrameError::Cobs => &mut self.cobs,
            FrameError::Crc => &mut self.crc,
            FrameError::Overlong => &mut self.overlong,
            FrameError::Unknown | FrameError::OtherVersion { .. } => &mut self.unknown,
        };
        *counter = counter.saturating_add(1);
    }
}

/// Decodes a stream of bytes into messages.
#[derive(Debug)]
pub struct Decoder {
    stuffing: DecoderState,
    payload: Vec<u8, MAX_PAYLOAD>,
    overlong: bool,
    bad: BadFrames,
}

impl Default for Decoder {
    fn default() -> Self {
        Self::new()
    }
}

impl Decoder {
    /// Creates a decoder that waits for the start of a frame.
    #[must_use]
    pub const fn new() -> Self {
        let bad = BadFrames { cobs: 0, crc: 0, overlong: 0, unknown: 0 };
        Self { stuffing: DecoderState::Idle, payload: Vec::new(), overlong: false, bad }
    }

    /// Returns the counts of rejected frames.
    #[must_use]
    pub const fn bad_frames(&self) -> BadFrames {
        self.bad
    }

    /// Takes one byte. Returns a result only at a delimiter that ends a frame.
    pub fn push<M: DeserializeOwned>(&mut self, byte: u8) -> Option<Result<M, FrameError>> {
        let result = match self.stuffing.feed(byte) {
            Ok(DecodeResult::NoData) => return None,
            Ok(DecodeResult::DataContinue(byte)) => {
                self.overlong |= self.payload.push(byte).is_err();
                return None;
            }
            Ok(DecodeResult::DataComplete) if self.overlong => Err(FrameError::Overlong),
            Ok(DecodeResult::DataComplete) => parse(&self.payload),
            Err(_) => Err(FrameError::Cobs),
        };
        if let Err(error) = result {
            self.bad.count(error);
        }
        self.payload.clear();
        self.overlong = false;
        Some(result)
    }
}

/// Checks the CRC and reads the message, which must use the complete payload.
fn parse<M: DeserializeOwned>(payload: &[u8]) -> Result<M, FrameError> {
    let (message, sum) = payload.split_last_chunk::<4>().ok_or(FrameError::Crc)?;
    if crc32(message) != u32::from_le_bytes(*sum) {
        return Err(FrameError::Crc);
    }
    match postcard::take_from_bytes::<M>(message) {
        Ok((value, [])) if other_version(message).is_none() => Ok(value),
        _ => Err(match other_version(message) {
            Some(found) => FrameError::OtherVersion { found },
            None => FrameError::Unknown,
        }),
    }
}

/// Returns the version of a hello frame of another protocol. In every version a hello frame starts
/// with its variant (0), the magic and the version.
fn other_version(message: &[u8]) -> Option<u8> {
    let rest = message.strip_prefix(&[0])?.strip_prefix(&MAGIC)?;
    rest.first().copied().filter(|&version| version != PROTOCOL_VERSION)
}
