//! The greeting: who the controller is, how it started and what it carries.

use serde::{Deserialize, Serialize};

use crate::State;
use crate::start::{StackReport, StartReport};

/// First bytes of a [`Hello`], so that a foreign device on the same port is recognised as foreign.
pub const MAGIC: [u8; 4] = *b"PNTL";

/// Version of the messages. Host and controller must agree; the host refuses any other.
pub const PROTOCOL_VERSION: u8 = 3;

/// Room for the build's name in a [`Hello`].
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

/// Where the controller runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Target {
    /// In the host's own process.
    Native,
    /// On the emulator.
    Emulator,
    /// On a microcontroller.
    Silicon,
}

/// What drives the controller's core after start-up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ClockSource {
    /// The host's clock; nothing was brought up.
    Host,
    /// PLL on the crystal.
    PllCrystal,
    /// PLL on the internal oscillator.
    PllInternal,
    /// The crystal without PLL.
    Crystal,
    /// The internal oscillator: all else failed, or is not there (the emulator).
    Internal,
}

/// Identifies one model image on board.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ModelId {
    /// CRC-32 of the image; 0 when the image was refused at start-up.
    pub crc: u32,
    /// Identifier of the training run that made it; 0 when the image was refused.
    pub training_id: u64,
}

/// Who the controller is and what it carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Hello {
    /// [`MAGIC`].
    pub magic: [u8; 4],
    /// [`PROTOCOL_VERSION`].
    pub protocol: u8,
    /// Name of the firmware's build.
    pub build_id: BuildId,
    /// Where it runs.
    pub target: Target,
    /// Clock that start-up arrived at.
    pub clock: ClockSource,
    /// Core frequency, Hz.
    pub core_hz: u32,
    /// Samples in the conditioning's window.
    pub window: u16,
    /// Model images by bearing code.
    pub models: [ModelId; 2],
    /// The token of the [`crate::ToController::Identify`] that asked for this; 0 when nobody asked: the controller has just started.
    pub token: u32,
    /// Number of the last command carried out; the next one must carry the number after it.
    pub last_command: u32,
    /// What the controller is doing.
    pub state: State,
    /// CRC-32 of the configuration in use in its serialised form; 0 without one.
    pub configuration_crc: u32,
    /// Why the controller started, and the fault before that.
    pub start: StartReport,
    /// Use of the stack.
    pub stack: StackReport,
}
