//! Parts that the STM32 microcontrollers share: watchdog, light, pins, samples, receive buffer,
//! flash sectors.
//!
//! `microcontroller` provides what differs: `pac` (registers), `port` (addresses and clocks of the
//! GPIO ports), `bus` (registers of the samples) and `sectors` (places and controller of the
//! flash).

mod acquisition;
mod inbox;
mod light;
mod pin;
mod registers;
mod sectors;
mod sensors;
mod slot_timer;
mod spi;
mod streams;
mod watchdog;

pub(super) use acquisition::Acquisition;
pub use acquisition::Collector;
pub(super) use inbox::{Inbox, LENGTH, Stream};
pub use light::Light;
pub(super) use pin::Pin;
pub(super) use sectors::Sectors;
pub use sensors::Sensors;
pub(super) use sensors::sampler;
pub(super) use spi::NoByte;
pub use watchdog::Watchdog;
