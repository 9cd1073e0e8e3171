//! What packages are kept in: NOR flash whose bytes can be read where they lie.

use embedded_storage::nor_flash::MultiwriteNorFlash;
use link::update::ModelMemory;

/// Two slots of the same size, one after the other, in one flash memory of its own.
///
/// Bits are only ever cleared by programming and set by erasing a slot as a whole; a word may be programmed again with more bits cleared, which
/// is how an interrupted update goes on ([`MultiwriteNorFlash`]; flash with error correction per word does not allow that).
pub trait SlotMemory: MultiwriteNorFlash {
    /// Whether the memory lasts without power.
    fn kind(&self) -> ModelMemory;

    /// Whether the core stands still while the memory is written, so that a run has to be stopped before.
    fn stalls_the_core(&self) -> bool;

    /// Bytes of the memory where they lie, at an address divisible by 4; fewer than asked for if they are not there.
    ///
    /// The store neither erases nor programs the slot whose bytes are in use: the networks run from one slot, the other is the one that is
    /// written. Bytes taken for checking are let go before the slot is written again.
    fn in_place(&self, offset: u32, length: u32) -> &'static [u8];
}
