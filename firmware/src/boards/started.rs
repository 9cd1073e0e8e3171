//! The board after its start: its parts and the transport of the link.

use super::microcontroller::{Collector, Inbox, Light, Receiver, Sensors, Transmitter, Watchdog};
use super::model_memory::Storage;
use super::rtt::Probe;
use super::semihosting::Files;
use super::timer::{Pacer, Timer};

/// Transport of the link.
pub enum Link {
    /// Files of the host, in lockstep: each sample frame is a tick.
    Files(Files),
    /// Serial port and debug probe, paced by a timer.
    Serial(Transmitter, Probe),
}

/// The started board.
pub struct Board {
    /// Identity in the hello frame.
    pub identity: controller::session::Identity,
    /// Reason of the start.
    pub start: link::start::StartReport,
    /// Transport of the link.
    pub link: Link,
    /// Receiving half of the serial port for its interrupt.
    pub receiver: Receiver,
    /// Received bytes that arrive without interrupts.
    pub inbox: Inbox,
    /// Counter that times a tick.
    pub timer: Timer,
    /// Clock of the ticks.
    pub pacer: Pacer,
    /// Hardware watchdog, running.
    pub watchdog: Watchdog,
    /// Indicator light.
    pub light: Light,
    /// Register of check-ins.
    pub attendance: controller::supervisor::Attendance,
    /// Memories for models and configuration.
    pub storage: Storage,
    /// Sensors, if the board has any.
    pub sensors: Option<Sensors>,
    /// Samples for the interrupt at their end.
    pub collector: Collector,
}
