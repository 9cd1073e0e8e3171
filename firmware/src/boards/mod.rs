//! The boards: the only code that accesses registers.
//!
//! A microcontroller is one file or folder that starts it (`start`) and provides its parts: the
//! device for the task framework, the link's serial port, the watchdog, the light, the flash
//! sectors. Everything else is shared. Facts about boards are in the table
//! [`controller::boards::BOARDS`].
//!
//! * `stm32f405/`: Cortex-M4F. One image runs on every board with an STM32F405 and on the
//!   emulator's `netduinoplus2`. It detects the emulator when it starts.
//! * `mps2_an505.rs`: Cortex-M33, Arm's prototyping board with image AN505; used as the emulator's
//!   `mps2-an505`.
//!
//! The link uses semihosting files if the emulator offers them. Otherwise it uses the serial port
//! or a debug probe, whichever the host used last. The serial port has run in the emulator only,
//! which models neither baud rate nor line errors. Clock start-up, pins and baud rate have not been
//! tried on silicon.

mod code;
mod fault;
mod guard;
mod log;
mod memory;
mod model_memory;
mod platform;
mod rtt;
mod semihosting;
mod serial_transport;
mod timer;

// One line per microcontroller.
#[cfg_attr(feature = "stm32f405", path = "stm32f405/mod.rs")]
#[cfg_attr(feature = "mps2-an505", path = "mps2_an505.rs")]
mod microcontroller;

pub use microcontroller::{
    Inbox, Light, PACKAGES_FOR, Receiver, Sensors, Transmitter, Watchdog, device, start,
};

#[cfg(feature = "provoke")]
mod provoke;
#[cfg(feature = "provoke")]
pub use provoke::provoke;

/// Notes that a party is at work.
pub fn check_in(attendance: &controller::supervisor::Attendance, party: controller::supervisor::Party) {
    #[cfg(feature = "provoke")]
    if provoke::keeps_away(party) {
        return;
    }
    attendance.check_in(party, uptime_us());
}

pub use code::{code_check, code_word};
pub use fault::give_up;
pub use memory::{stack_mark, stack_used};
pub use model_memory::{Memory, Storage};
pub use platform::Platform;
pub use rtt::Probe;
pub use semihosting::{Files, leave};
pub use serial_transport::{SerialTransport, receive};
pub use timer::{Pacer, Timer, uptime_us};

/// Name of this build: `git describe`, or the crate's version.
///
/// The compiler must not know the name: it would compute the name's checksum and unroll its copy,
/// and the size of the image would depend on the name.
fn build_id() -> link::BuildId {
    link::BuildId(*core::hint::black_box(&rtt::PINTLE_BUILD_ID))
}

/// Row of the table for the board of this image. `build.rs` checks the name and sets it.
pub static BOARD: &controller::boards::Board = match controller::boards::find(env!("PINTLE_BOARD")) {
    Some(board) => board,
    None => panic!("PINTLE_BOARD names no board of the table"),
};

/// Transport of the link.
pub enum Link {
    /// Files of the host, in lockstep: each sample frame is a tick.
    Files(Files),
    /// Serial port and debug probe, paced by SysTick.
    Serial(Transmitter, Probe),
}

/// Content of the serial port's registers at its interrupt.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReceiveEvent {
    /// Received byte if bytes arrive by interrupt.
    pub byte: Option<u8>,
    /// Errors of this byte, each 0 or 1.
    pub errors: link::LineErrors,
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
}
