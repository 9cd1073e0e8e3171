//! Greetings: which are accepted, and what stands for one that has not come yet.

use super::ControllerError;
use link::start::{StackReport, StartReport};
use link::{BuildId, ClockSource, Hello, MAGIC, ModelId, PROTOCOL_VERSION, State, Target};

/// Accepts a greeting of this protocol only.
pub(super) fn greeted(hello: Hello) -> Result<Hello, ControllerError> {
    if hello.magic == MAGIC && hello.protocol == PROTOCOL_VERSION {
        Ok(hello)
    } else {
        Err(ControllerError::Version { found: hello.protocol, expected: PROTOCOL_VERSION })
    }
}

/// Stands for a greeting that has not come yet.
pub(super) fn unknown() -> Hello {
    Hello {
        magic: [0; 4],
        protocol: 0,
        build_id: BuildId::new(""),
        target: Target::Silicon,
        clock: ClockSource::Internal,
        core_hz: 0,
        window: 0,
        models: [ModelId { crc: 0, training_id: 0 }; 2],
        token: 0,
        last_command: 0,
        state: State::Waiting,
        configuration_crc: 0,
        start: StartReport::default(),
        stack: StackReport::default(),
    }
}
