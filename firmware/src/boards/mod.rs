//! The boards: the one place that touches registers.
//!
//! One image serves every board with an STM32F405 (Adafruit Feather STM32F405, Olimex STM32-H405, Netduino Plus 2) and the emulator's
//! `netduinoplus2`; which of the two it is, it finds out when it starts.
//!
//! The link goes over semihosting files where the emulator offers them, else over [`serial`]. On a real board that is
//! USART3 on PB10 (out) and PB11 (in): the Feather's TX and RX pins. The serial path has been tried on the emulator's USART only,
//! which knows neither baud rate nor line errors; clock bring-up, pins and baud rate are still to be seen on silicon.

mod clock_tree;
mod fault;
mod log;
mod semihosting;
mod serial;
mod stm32f405;
mod timer;

pub use log::count_log_tick;
pub use semihosting::{Files, leave};
pub use serial::{Receiver, Transmitter};
pub use stm32f405::{Board, Link, start};
pub use timer::{TICKS_PER_SECOND, Timer, tick_is_pending};
