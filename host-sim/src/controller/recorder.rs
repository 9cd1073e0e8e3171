//! Listens to a conversation: every frame either way, with the sequence number of the sample it belongs to.

use super::{ControllerError, framed};
use link::{MAX_FRAME, ToController, ToHost};
use std::sync::{Arc, Mutex, PoisonError};

/// Which way a frame went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Way {
    /// From the host.
    ToController = 0,
    /// From the controller.
    ToHost = 1,
}

/// A frame as it went over the line, delimiter included.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordedFrame {
    /// Which way.
    pub way: Way,
    /// Sequence number of the last sample that the host had sent; none before the first.
    pub sequence: Option<u32>,
    /// Its bytes.
    pub bytes: Vec<u8>,
}

/// Takes what a controller's end exchanges. Clones share what they have heard.
#[derive(Clone, Debug, Default)]
pub struct Recorder(Arc<Mutex<Heard>>);

#[derive(Debug, Default)]
struct Heard {
    sequence: Option<u32>,
    frames: Vec<RecordedFrame>,
}

impl Recorder {
    /// Takes a message of the host. A message has one frame only, so its frame is what goes over the line.
    pub(super) fn sent(&self, message: &ToController) -> Result<(), ControllerError> {
        let mut heard = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let ToController::Sensor(sample, _) = message {
            heard.sequence = Some(sample.sequence);
        }
        heard.take(Way::ToController, message)
    }

    /// Takes a message of the controller.
    pub(super) fn received(&self, message: &ToHost) -> Result<(), ControllerError> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take(Way::ToHost, message)
    }

    /// What has been heard so far; it is forgotten here.
    #[must_use]
    pub fn take(&self) -> Vec<RecordedFrame> {
        std::mem::take(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner).frames)
    }
}

impl Heard {
    fn take(&mut self, way: Way, message: &impl serde::Serialize) -> Result<(), ControllerError> {
        let mut buffer = [0; MAX_FRAME];
        let bytes = framed(message, &mut buffer)?.to_vec();
        self.frames.push(RecordedFrame { way, sequence: self.sequence, bytes });
        Ok(())
    }
}
