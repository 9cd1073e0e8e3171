//! Parts that this board does not have or use.

use controller::sensors::{Collected, Completion};
use controller::store::controller::FlashError;

/// No watchdog.
pub struct Watchdog;

impl Watchdog {
    /// Does nothing.
    pub fn kick(&mut self) {}
}

/// No sensors.
pub type Sensors = core::convert::Infallible;

/// No samples.
pub struct Collector;

impl Collector {
    /// Reads no counters.
    #[must_use]
    pub const fn now(&self) -> Completion {
        Completion { time_us: 0, cycles: 0 }
    }

    /// Finds nothing.
    pub fn collect(&mut self) -> Option<Collected> {
        None
    }
}

/// No flash to write.
#[derive(Debug)]
pub(in crate::boards) enum Sectors {}

impl Sectors {
    /// Length of a word, bytes.
    pub(in crate::boards) const WORD_LENGTH: usize = 4;
    /// True if a word must not be programmed twice.
    pub(in crate::boards) const IS_WRITE_ONCE: bool = false;

    pub(in crate::boards) const fn start(&self) -> usize {
        match *self {}
    }

    pub(in crate::boards) const fn length(&self) -> usize {
        match *self {}
    }

    pub(in crate::boards) const fn is_readable(&self, _start: usize, _length: usize) -> bool {
        match *self {}
    }

    pub(in crate::boards) fn erase(&mut self, _start: usize, _length: usize) -> Result<(), FlashError> {
        match *self {}
    }

    pub(in crate::boards) fn program(&mut self, _address: usize, _bytes: &[u8]) -> Result<(), FlashError> {
        match *self {}
    }
}

/// No light.
pub struct Light;

impl Light {
    /// Does nothing.
    pub fn show(&mut self, _on: bool) {}
}
