//! Records a link session: every frame in both directions, with the sequence number of the sample
//! that it belongs to.

use super::ControllerError;
use super::error::unexpected;
use link::{MAX_FRAME, ToController, ToHost, encode};
use std::sync::{Arc, Mutex, PoisonError};

/// Direction of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Direction {
    /// From the host to the controller.
    ToController = 0,
    /// From the controller to the host.
    ToHost = 1,
}

/// A frame as it crossed the line, delimiter included.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordedFrame {
    /// Its direction.
    pub way: Direction,
    /// Sequence number of the last sample that the host had sent; none before the first.
    pub sequence: Option<u32>,
    /// Its bytes.
    pub bytes: Vec<u8>,
}

/// Collects the frames of a link session. Clones share what they have collected.
#[derive(Clone, Debug, Default)]
pub struct Recorder(Arc<Mutex<Received>>);

#[derive(Debug, Default)]
struct Received {
    sequence: Option<u32>,
    frames: Vec<RecordedFrame>,
}

impl Recorder {
    /// Records a message of the host. Every message has exactly one encoding, so the frame is what
    /// crossed the line.
    pub(super) fn sent(&self, message: &ToController) -> Result<(), ControllerError> {
        let mut frames = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let ToController::Sensor(sample, _) = message {
            frames.sequence = Some(sample.sequence);
        }
        frames.take(Direction::ToController, message)
    }

    /// Records a message of the controller.
    pub(super) fn received(&self, message: &ToHost) -> Result<(), ControllerError> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take(Direction::ToHost, message)
    }

    /// Returns the frames so far and forgets them.
    #[must_use]
    pub fn take(&self) -> Vec<RecordedFrame> {
        std::mem::take(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner).frames)
    }
}

impl Received {
    fn take(&mut self, way: Direction, message: &impl serde::Serialize) -> Result<(), ControllerError> {
        let mut buffer = [0; MAX_FRAME];
        let bytes = framed(message, &mut buffer)?.to_vec();
        self.frames.push(RecordedFrame { way, sequence: self.sequence, bytes });
        Ok(())
    }
}

/// Encodes a message as a frame.
pub(super) fn framed<'a>(
    message: &impl serde::Serialize,
    buffer: &'a mut [u8; MAX_FRAME],
) -> Result<&'a [u8], ControllerError> {
    encode(message, buffer).map_err(|error| unexpected(&error, "a message that fits a frame"))
}
