//! Parts that the STM32 microcontrollers share: watchdog, light, pins, sensor bus, receive buffer.
//!
//! `microcontroller` provides what differs: `pac` (registers), `port` (addresses and clocks of the
//! GPIO ports) and `bus` (registers of the sensor bus).

mod inbox;
mod light;
mod pin;
mod sensors;
pub(super) mod spi;
mod watchdog;

pub(super) use inbox::{Inbox, LENGTH, Stream};
pub use light::Light;
pub(super) use pin::Pin;
pub(super) use sensors::{Sensors, sampler};
pub use watchdog::Watchdog;
