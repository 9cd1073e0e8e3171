//! Memory for packages: NOR flash whose bytes can be read in place.

use embedded_storage::nor_flash::NorFlash;
use link::update::ModelMemory;

/// Two slots of the same size, one after the other, in a separate flash memory.
///
/// Programming only clears bits, and erasing a slot sets them all. [`NorFlash::WRITE_SIZE`] is the
/// length of a flash word: 4, 8, 16 or 32 bytes. A word is programmed completely. A loss of power
/// can leave it unreadable, which is an error of `read`.
pub trait SlotMemory: NorFlash {
    /// True if a word must not be programmed again before it is erased, as in flash with error
    /// correction per word. Otherwise an interrupted update programs its last words again, with
    /// more bits cleared.
    const IS_WRITE_ONCE: bool = false;

    /// Returns whether the memory lasts without power.
    fn kind(&self) -> ModelMemory;

    /// Decides whether the core stalls while the memory is written, so that a run has to be stopped
    /// before.
    fn stalls_the_core(&self) -> bool;

    /// Returns bytes of the memory in place, at an address divisible by 4; fewer than requested if
    /// they do not exist or cannot be read.
    ///
    /// The store neither erases nor programs the slot whose bytes are in use: the networks run from
    /// one slot, and the other one is written. Bytes taken for a check are released before the slot
    /// is written again.
    fn in_place(&self, offset: u32, length: u32) -> &'static [u8];
}
