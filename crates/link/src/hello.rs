//! The hello frame: identity of the controller, cause of its start, models on board.

use serde::{Deserialize, Serialize};

use crate::authentication::Authentication;
use crate::start::{StackReport, StartReport};

/// First bytes of a [`Hello`], so that a foreign device on the same port is recognised as foreign.
pub const MAGIC: [u8; 4] = *b"PNTL";

/// Version of the messages. Host and controller must agree; the host refuses any other.
pub const PROTOCOL_VERSION: u8 = 8;

/// Length of the build's name in a [`Hello`], in bytes.
pub const BUILD_ID_LEN: usize = 32;

/// Name of a build (`git describe`, or the crate's version), padded with zeros.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BuildId(pub [u8; BUILD_ID_LEN]);

impl BuildId {
    /// Takes the first [`BUILD_ID_LEN`] bytes of a name.
    #[must_use]
    pub fn new(name: &str) -> Self {
        let mut bytes = [0; BUILD_ID_LEN];
        for (to, from) in bytes.iter_mut().zip(name.bytes()) {
            *to = from;
        }
        Self(bytes)
    }

    /// The name as text; empty when the bytes are not UTF-8.
    #[must_use]
    pub fn as_str(&self) -> &str {
        let end = self.0.iter().position(|&b| b == 0).unwrap_or(BUILD_ID_LEN);
        self.0.get(..end).and_then(|name| core::str::from_utf8(name).ok()).unwrap_or_default()
    }
}

/// Place where the controller runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Target {
    /// Process of the host.
    Native,
    /// Emulator.
    Emulator,
    /// Microcontroller.
    Silicon,
}

/// Clock source of the controller's core after start-up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ClockSource {
    /// Clock of the host; no clock was started.
    Host,
    /// PLL on the crystal.
    PllCrystal,
    /// PLL on the internal oscillator.
    PllInternal,
    /// Crystal without PLL.
    Crystal,
    /// Internal oscillator: the other sources failed or do not exist (emulator).
    Internal,
}

/// Number of bearing materials that a hello frame and a package have room for. A change also
/// changes [`PROTOCOL_VERSION`].
pub const MODELS: usize = 5;

/// Identity of a model image on board.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ModelId {
    /// CRC-32 of the image; 0 if the image was rejected at start-up.
    pub crc: u32,
    /// Identifier of the training run; 0 if the image was rejected.
    pub training_id: u64,
}

impl ModelId {
    /// Identity of a rejected image, or of a material that does not exist.
    pub const NONE: Self = Self { crc: 0, training_id: 0 };
}

/// State of the controller.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum State {
    /// Waiting for a configuration.
    #[default]
    Waiting,
    /// Estimating.
    Running,
    /// Tripped by late estimates: the last good estimate is held until
    /// [`crate::Command::ClearTrip`].
    Tripped,
}

/// Identity and state of a controller, with the models that it carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Hello {
    /// [`MAGIC`].
    pub magic: [u8; 4],
    /// [`PROTOCOL_VERSION`].
    pub protocol: u8,
    /// Name of the firmware's build.
    pub build_id: BuildId,
    /// Place where it runs.
    pub target: Target,
    /// Clock source after start-up.
    pub clock: ClockSource,
    /// Core frequency, Hz.
    pub core_hz: u32,
    /// Samples in the window of the networks.
    pub window: u16,
    /// Model images by bearing code.
    pub models: [ModelId; MODELS],
    /// Token of the [`crate::ToController::Identify`] that requested this frame. It is 0 if the
    /// controller sent the frame on its own after a start.
    pub token: u32,
    /// Number of the last command carried out; the next one must carry the number after it.
    pub last_command: u32,
    /// State of the run.
    pub state: State,
    /// CRC-32 of the configuration in use in its serialised form; 0 without one.
    pub configuration_crc: u32,
    /// Cause of the last start, and the fault before it.
    pub start: StartReport,
    /// Use of the stack.
    pub stack: StackReport,
    /// Authentication of commands.
    pub authentication: Authentication,
}
