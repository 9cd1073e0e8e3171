//! Sequence of a flash controller's erase and program operations, with timeouts.
//!
//! A timeout is a number of polls. Every outcome has a name. The trait [`FlashPort`]
//! separates the registers, so that the host tests the sequence. Order and keys: RM0090 section 3.6
//! (embedded flash memory interface, program and erase operations), RM0433 section 4.3.

use embedded_storage::nor_flash::{NorFlashError, NorFlashErrorKind};

/// Polls before an erase operation times out: about 6 s at 168 MHz and 10 cycles per poll, and more
/// than 2 s at 480 MHz. A sector of 128 KiB takes at most 2 s.
const ERASE_POLLS: u32 = 100_000_000;
/// Polls before a word times out: about 6 ms. A word takes at most 100 us.
const PROGRAM_POLLS: u32 = 100_000;

/// Status of the flash controller.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Status {
    /// An operation is in progress.
    pub busy: bool,
    /// Error bits; 0 is none.
    pub errors: u16,
}

/// Registers of the flash controller.
pub trait FlashPort {
    /// Length of a flash word, which is programmed in one operation, bytes: 4, or 32 on the
    /// STM32H743.
    const WORD_LENGTH: usize;

    /// Reads the status.
    fn status(&self) -> Status;
    /// Clears the error bits.
    fn clear_errors(&mut self);
    /// Writes the keys. Returns whether the controller accepted them.
    fn unlock(&mut self) -> bool;
    /// Locks the controller again.
    fn lock(&mut self);
    /// Starts erasing a sector.
    fn start_erase(&mut self, sector: u8);
    /// Enables or disables programming.
    fn programming(&mut self, on: bool);
    /// Stores 4 bytes. The last ones of a flash word start its programming.
    fn store(&mut self, address: u32, word: u32);
    /// Invalidates the caches of the flash.
    fn flush(&mut self);
}

/// Error of a flash operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlashError {
    /// Alignment error: not complete words, or not complete sectors.
    NotAligned,
    /// Outside the memory.
    OutOfBounds,
    /// A word cannot be read: its programming was interrupted, or it has lost bits.
    Unreadable,
    /// The controller refused the keys and accepts none until the next reset.
    Locked,
    /// The operation timed out.
    TimedOut,
    /// The controller reported errors.
    Reported {
        /// Error bits.
        errors: u16,
    },
}

impl NorFlashError for FlashError {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::NotAligned => NorFlashErrorKind::NotAligned,
            Self::OutOfBounds => NorFlashErrorKind::OutOfBounds,
            _ => NorFlashErrorKind::Other,
        }
    }
}

/// Erases one sector.
///
/// # Errors
///
/// The controller stays locked, the operation times out or reports an error.
pub fn erase(port: &mut impl FlashPort, sector: u8) -> Result<(), FlashError> {
    unlocked(port, |port| {
        port.start_erase(sector);
        finished(port, ERASE_POLLS)
    })
}

/// Programs bytes word by word at an address divisible by the length of a word.
///
/// # Errors
///
/// As [`erase`]; bytes that are not complete words.
pub fn program<P: FlashPort>(port: &mut P, address: u32, bytes: &[u8]) -> Result<(), FlashError> {
    if !(address as usize | bytes.len()).is_multiple_of(P::WORD_LENGTH) {
        return Err(FlashError::NotAligned);
    }
    unlocked(port, |port| {
        port.programming(true);
        let mut address = address;
        let done = bytes.chunks_exact(P::WORD_LENGTH).try_for_each(|word| {
            for part in word.as_chunks::<4>().0 {
                port.store(address, u32::from_le_bytes(*part));
                address = address.wrapping_add(4);
            }
            finished(port, PROGRAM_POLLS)
        });
        port.programming(false);
        done
    })
}

fn unlocked<P: FlashPort>(
    port: &mut P,
    work: impl FnOnce(&mut P) -> Result<(), FlashError>,
) -> Result<(), FlashError> {
    // An operation that timed out may still be in progress.
    if !(0..PROGRAM_POLLS).any(|_| !port.status().busy) {
        return Err(FlashError::TimedOut);
    }
    port.clear_errors();
    if !port.unlock() {
        return Err(FlashError::Locked);
    }
    let done = work(port);
    port.lock();
    port.flush();
    done
}

fn finished(port: &mut impl FlashPort, polls: u32) -> Result<(), FlashError> {
    if !(0..polls).any(|_| !port.status().busy) {
        return Err(FlashError::TimedOut);
    }
    match port.status().errors {
        0 => Ok(()),
        errors => {
            port.clear_errors();
            Err(FlashError::Reported { errors })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::cell::Cell;

    /// A controller with four times 4 bytes and flash words of some length that stays busy for some
    /// polls after each operation.
    struct Fake<const WORD: usize> {
        words: [u32; 4],
        busy: Cell<u32>,
        work: u32,
        errors: u16,
        next_errors: u16,
        keys_accepted: bool,
        open: bool,
        programming: bool,
        flushed: bool,
    }

    fn fake() -> Fake<4> {
        fake_of()
    }

    fn fake_of<const WORD: usize>() -> Fake<WORD> {
        Fake {
            words: [u32::MAX; 4],
            busy: Cell::new(0),
            work: 3,
            errors: 0,
            next_errors: 0,
            keys_accepted: true,
            open: false,
            programming: false,
            flushed: false,
        }
    }

    impl<const WORD: usize> FlashPort for Fake<WORD> {
        const WORD_LENGTH: usize = WORD;

        fn status(&self) -> Status {
            let left = self.busy.get();
            self.busy.set(left.saturating_sub(1));
            Status { busy: left > 0, errors: self.errors }
        }

        fn clear_errors(&mut self) {
            self.errors = 0;
        }

        fn unlock(&mut self) -> bool {
            self.open = self.keys_accepted;
            self.open
        }

        fn lock(&mut self) {
            self.open = false;
        }

        fn start_erase(&mut self, sector: u8) {
            assert!(self.open && !self.programming && sector == 10);
            self.words = [u32::MAX; 4];
            self.busy.set(self.work);
            self.errors = self.next_errors;
        }

        fn programming(&mut self, on: bool) {
            assert!(self.open);
            self.programming = on;
        }

        fn store(&mut self, address: u32, word: u32) {
            assert!(self.open && self.programming && self.busy.get() == 0);
            self.words[address as usize / 4] &= word;
            if !(address as usize + 4).is_multiple_of(WORD) {
                return;
            }
            self.busy.set(self.work);
            self.errors = self.next_errors;
        }

        fn flush(&mut self) {
            assert!(!self.open);
            self.flushed = true;
        }
    }

    #[test]
    fn words_are_programmed_one_after_the_other_and_the_flash_is_locked_again() {
        let mut port = fake();
        assert_eq!(program(&mut port, 4, &[1, 0, 0, 0, 2, 0, 0, 0]), Ok(()));
        assert_eq!(port.words, [u32::MAX, 1, 2, u32::MAX]);
        assert!(!port.open && !port.programming && port.flushed);
        assert_eq!(erase(&mut port, 10), Ok(()));
        assert_eq!(port.words, [u32::MAX; 4]);
    }

    #[test]
    fn a_longer_word_is_stored_completely_before_its_end_is_awaited() {
        let mut port = fake_of::<8>();
        let bytes = [[1, 0, 0, 0], [2, 0, 0, 0], [3, 0, 0, 0], [4, 0, 0, 0]];
        assert_eq!(program(&mut port, 0, bytes.as_flattened()), Ok(()));
        assert_eq!(port.words, [1, 2, 3, 4]);
        assert_eq!(port.busy.get(), 0, "the end of the last word was awaited");
        for (address, bytes) in [(4, 8), (0, 4), (0, 12)] {
            assert_eq!(program(&mut port, address, &[0; 16][..bytes]), Err(FlashError::NotAligned));
        }
        assert_eq!(port.words, [1, 2, 3, 4]);
    }

    #[test]
    fn half_words_and_odd_addresses_are_refused_before_anything_is_touched() {
        let mut port = fake();
        assert_eq!(program(&mut port, 0, &[1, 2, 3]), Err(FlashError::NotAligned));
        assert_eq!(program(&mut port, 2, &[1, 2, 3, 4]), Err(FlashError::NotAligned));
        assert_eq!(port.words, [u32::MAX; 4]);
    }

    #[test]
    fn every_failure_has_a_name_and_a_timeout() {
        let mut hanging = Fake { work: u32::MAX, ..fake() };
        assert_eq!(program(&mut hanging, 0, &[0; 4]), Err(FlashError::TimedOut));
        assert!(!hanging.open, "shut again all the same");
        assert_eq!(program(&mut hanging, 0, &[0; 4]), Err(FlashError::TimedOut));
        let mut failing = Fake { next_errors: 0x10, ..fake() };
        assert_eq!(erase(&mut failing, 10), Err(FlashError::Reported { errors: 0x10 }));
        assert_eq!(failing.errors, 0, "cleared for the next operation");
        let mut shut = Fake { keys_accepted: false, ..fake() };
        assert_eq!(erase(&mut shut, 10), Err(FlashError::Locked));
    }
}
