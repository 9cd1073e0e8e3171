//! Pairs of flash sectors of 128 KiB for data that is written at run time. What differs between the
//! microcontrollers is in the file `sectors.rs` of each.

use controller::store::controller::{FlashError, FlashPort, erase, program};

use super::super::microcontroller::sectors::{self, Port};

const SECTOR_BYTES: usize = 128 * 1024;

/// Two adjacent sectors.
#[derive(Debug)]
pub(in crate::boards) struct Sectors {
    first: u8,
}

impl Sectors {
    /// Length of a flash word, bytes.
    pub(in crate::boards) const WORD_LENGTH: usize = Port::WORD_LENGTH;
    /// True if a word must not be programmed twice.
    pub(in crate::boards) const IS_WRITE_ONCE: bool = sectors::IS_WRITE_ONCE;

    pub(in crate::boards) const CONFIGURATION: Self = Self { first: sectors::CONFIGURATION };
    pub(in crate::boards) const MODELS: Self = Self { first: sectors::MODELS };

    pub(in crate::boards) const fn start(&self) -> usize {
        sectors::ORIGIN.wrapping_add((self.first as usize).wrapping_mul(SECTOR_BYTES))
    }

    pub(in crate::boards) const fn length(&self) -> usize {
        2 * SECTOR_BYTES
    }

    /// Decides whether every byte of a range can be read.
    pub(in crate::boards) fn is_readable(&self, start: usize, length: usize) -> bool {
        sectors::is_readable(start, length)
    }

    /// Erases complete sectors. Interrupts wait meanwhile: the supervisor would miss the link
    /// service. The watchdog lasts longer.
    pub(in crate::boards) fn erase(&mut self, start: usize, length: usize) -> Result<(), FlashError> {
        let offset = start.checked_sub(self.start()).ok_or(FlashError::OutOfBounds)?;
        if !offset.is_multiple_of(SECTOR_BYTES) || !length.is_multiple_of(SECTOR_BYTES) {
            return Err(FlashError::NotAligned);
        }
        let [from, count] = [offset / SECTOR_BYTES, length / SECTOR_BYTES].map(|number| number as u8);
        let first = self.first.saturating_add(from);
        (first..first.saturating_add(count))
            .try_for_each(|sector| cortex_m::interrupt::free(|_| erase(&mut Port, sector)))
    }

    /// Programs complete flash words.
    pub(in crate::boards) fn program(&mut self, address: usize, bytes: &[u8]) -> Result<(), FlashError> {
        program(&mut Port, address as u32, bytes)
    }
}
