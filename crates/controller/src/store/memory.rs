//! Memory for packages: NOR flash whose bytes can be read in place.

use embedded_storage::nor_flash::MultiwriteNorFlash;
use link::update::ModelMemory;

/// Two slots of the same size, one after the other, in a separate flash memory.
///
/// Programming only clears bits, and erasing a slot sets them all. A word may be programmed again
/// with more bits cleared; an interrupted update continues that way ([`MultiwriteNorFlash`]). Flash
/// with error correction per word does not allow this.
pub trait SlotMemory: MultiwriteNorFlash {
    /// Returns whether the memory lasts without power.
    fn kind(&self) -> ModelMemory;

    /// Decides whether the core stalls while the memory is written, so that a run has to be stopped
    /// before.
    fn stalls_the_core(&self) -> bool;

    /// Returns bytes of the memory in place, at an address divisible by 4; fewer than requested if
    /// they do not exist.
    ///
    /// The store neither erases nor programs the slot whose bytes are in use: the networks run from
    /// one slot, and the other one is written. Bytes taken for a check are released before the slot
    /// is written again.
    fn in_place(&self, offset: u32, length: u32) -> &'static [u8];
}
