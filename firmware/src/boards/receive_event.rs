//! Reception of the serial port.

/// Content of the serial port's registers at its interrupt.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ReceiveEvent {
    /// Received byte if bytes arrive by interrupt.
    pub(super) byte: Option<u8>,
    /// Errors of this byte, each 0 or 1.
    pub(super) errors: link::LineErrors,
}
