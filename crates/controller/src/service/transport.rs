//! Transports of the link and the ports that the service reads.

use crate::session::LineReport;
use link::{DELIMITER, Decoder, FrameError, ToController};

/// Result of [`Transport::receive`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Received {
    /// The next byte.
    Byte(u8),
    /// No byte has arrived.
    Nothing,
    /// The host has closed the transport; no byte will follow.
    Closed,
}

/// Purpose of a frame that is sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Reply to a request.
    Reply,
    /// Estimate or telemetry. A transport with a small buffer leaves room for a reply.
    Stream,
}

/// Carries the bytes of the link: a serial port, a debug probe or files of the host.
pub trait Transport {
    /// Takes the next received byte. Only a lockstep transport waits for it.
    fn receive(&mut self) -> Received;

    /// Sends one frame within a bounded time. Returns false if the transport did not take all of
    /// it.
    #[must_use]
    fn send(&mut self, frame: &[u8], purpose: Purpose) -> bool;

    /// Returns the losses on the way in.
    fn line(&self) -> LineReport {
        LineReport::default()
    }
}

/// A transport without an endpoint.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unconnected;

impl Transport for Unconnected {
    fn receive(&mut self) -> Received {
        Received::Nothing
    }

    fn send(&mut self, _frame: &[u8], _purpose: Purpose) -> bool {
        true
    }
}

/// One of the two ports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PortId {
    First,
    Second,
}

/// Result of [`Ports::receive`].
pub(super) enum Event {
    Nothing,
    Closed,
    /// A byte that does not end a frame.
    Byte,
    /// A message, or a frame that could not be decoded.
    Message(PortId, Result<ToController, FrameError>),
}

struct Port<T> {
    transport: T,
    decoder: Decoder,
}

impl<T: Transport> Port<T> {
    const fn new(transport: T) -> Self {
        Self { transport, decoder: Decoder::new() }
    }
}

/// Two transports, each with its decoder. Estimates and telemetry go to the one that carried the
/// last valid frame, to the first one at the start.
pub struct Ports<A, B> {
    first: Port<A>,
    second: Port<B>,
    host: PortId,
}

impl<A: Transport, B: Transport> Ports<A, B> {
    /// Creates the ports. The first one is read first.
    pub const fn new(first: A, second: B) -> Self {
        Self { first: Port::new(first), second: Port::new(second), host: PortId::First }
    }

    /// Takes one byte of the first transport that has one and decodes it.
    pub(super) fn receive(&mut self) -> Event {
        let (port, received) = match self.first.transport.receive() {
            Received::Nothing => (PortId::Second, self.second.transport.receive()),
            received => (PortId::First, received),
        };
        let byte = match received {
            Received::Byte(byte) => byte,
            Received::Nothing => return Event::Nothing,
            Received::Closed => return Event::Closed,
        };
        let decoder = match port {
            PortId::First => &mut self.first.decoder,
            PortId::Second => &mut self.second.decoder,
        };
        let Some(message) = decoder.push::<ToController>(byte) else { return Event::Byte };
        if message.is_ok() {
            self.host = port;
        }
        Event::Message(port, message)
    }

    /// Sends a frame through one port.
    pub(super) fn send(&mut self, port: PortId, frame: &[u8], purpose: Purpose) -> bool {
        match port {
            PortId::First => self.first.transport.send(frame, purpose),
            PortId::Second => self.second.transport.send(frame, purpose),
        }
    }

    /// Sends an estimate or telemetry.
    pub(super) fn send_to_host(&mut self, frame: &[u8]) -> bool {
        self.send(self.host, frame, Purpose::Stream)
    }

    /// Sends a frame through both ports.
    pub(super) fn send_everywhere(&mut self, frame: &[u8]) -> bool {
        let [first, second] =
            [PortId::First, PortId::Second].map(|port| self.send(port, frame, Purpose::Reply));
        first && second
    }

    /// Ends a frame that a reset may have cut short, so that it does not swallow the next one.
    pub(super) fn end_frame(&mut self) {
        let _ = self.send_everywhere(&[DELIMITER]);
    }

    /// Returns the losses of the first transport, which is the one with a line.
    pub(super) fn line(&self) -> LineReport {
        self.first.transport.line()
    }
}
