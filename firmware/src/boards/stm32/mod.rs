//! Parts that the STM32 microcontrollers share: watchdog, light, pins, sensor bus, receive buffer,
//! flash sectors.
//!
//! `microcontroller` provides what differs: `pac` (registers), `port` (addresses and clocks of the
//! GPIO ports), `bus` (registers of the sensor bus) and `sectors` (places and controller of the
//! flash).

mod inbox;
mod light;
mod pin;
mod sectors;
mod sensors;
pub(super) mod spi;
mod watchdog;

pub(super) use inbox::{Inbox, LENGTH, Stream};
pub use light::Light;
pub(super) use pin::Pin;
pub(super) use sectors::Sectors;
pub(super) use sensors::{Sensors, sampler};
pub use watchdog::Watchdog;
