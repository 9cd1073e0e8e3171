//! The boards: the only code that accesses registers.
//!
//! A microcontroller is one file or folder that starts it (`start`) and provides its parts: the
//! device for the task framework, the link's serial port, the watchdog, the light, the flash
//! sectors. Everything else is shared. Facts about boards are in the table
//! [`controller::boards::BOARDS`].
//!
//! * `stm32f405/`: Cortex-M4F. One image runs on every board with an STM32F405 and on the
//!   emulator's `netduinoplus2`. It detects the emulator when it starts.
//! * `stm32h743/`: Cortex-M7 with two banks of flash. No emulator models it.
//! * `mps2_an505/`: Cortex-M33, Arm's prototyping board with image AN505; used as the emulator's
//!   `mps2-an505`.
//!
//! The link uses semihosting files if the emulator offers them. Otherwise it uses the serial port
//! or a debug probe, whichever the host used last. The serial port has run in the emulator only,
//! which models neither baud rate nor line errors. Clock start-up, pins and baud rate have not been
//! tried on silicon.

mod check_in;
mod code;
mod fault;
mod guard;
mod image;
mod log;
mod log_text;
mod memory;
mod model_memory;
mod platform;
mod receive_event;
mod rtt;
#[cfg_attr(feature = "stm32h743", expect(dead_code, reason = "no emulator models this microcontroller"))]
mod semihosting;
mod serial_transport;
mod started;
#[cfg(any(feature = "stm32f405", feature = "stm32h743"))]
mod stm32;
mod timer;

// One line per microcontroller.
#[cfg_attr(feature = "stm32f405", path = "stm32f405/mod.rs")]
#[cfg_attr(feature = "stm32h743", path = "stm32h743/mod.rs")]
#[cfg_attr(feature = "mps2-an505", path = "mps2_an505/mod.rs")]
mod microcontroller;

pub use microcontroller::{Collector, Light, PACKAGES_FOR, Receiver, Sensors, Watchdog, device, start};

#[cfg(feature = "provoke")]
mod provoke;
#[cfg(feature = "provoke")]
pub use provoke::{provoke, provoke_at_end};

pub use check_in::check_in;
pub use code::code_check;
pub use fault::give_up;
pub use image::BOARD;
pub use log_text::started;
pub use memory::stack_mark;
pub use model_memory::{Memory, Storage};
pub use platform::Platform;
pub use rtt::Probe;
pub use semihosting::{Files, leave};
pub use serial_transport::{SerialTransport, receive};
pub use started::{Board, Link};
pub use timer::{COLLECTED, Pacer, Timer, postpone, uptime_us};
