//! Checks of hello frames.

use super::ControllerError;
use link::authentication::Authentication;
use link::start::{StackReport, StartReport};
use link::{BuildId, ClockSource, Hello, MAGIC, ModelId, PROTOCOL_VERSION, State, Target};

/// Accepts a hello of this protocol only.
pub(super) fn check_hello(hello: Hello) -> Result<Hello, ControllerError> {
    if hello.magic == MAGIC && hello.protocol == PROTOCOL_VERSION {
        Ok(hello)
    } else {
        Err(ControllerError::Version { found: hello.protocol, expected: PROTOCOL_VERSION })
    }
}

/// Placeholder until the controller's hello has arrived.
pub(super) fn no_hello() -> Hello {
    Hello {
        magic: [0; 4],
        protocol: 0,
        build_id: BuildId::new(""),
        target: Target::Silicon,
        clock: ClockSource::Internal,
        core_hz: 0,
        window: 0,
        models: [ModelId::NONE; link::MODELS],
        token: 0,
        last_command: 0,
        state: State::Waiting,
        configuration_crc: 0,
        start: StartReport::default(),
        stack: StackReport::default(),
        authentication: Authentication::Open,
    }
}
