//! The last four sectors of flash bank 2, 128 KiB each, for data that is written at run time
//! (RM0433 section 4.3).
//!
//! | sectors of bank 2 | address | content |
//! |---|---|---|
//! | 4, 5 | 0x0818_0000 | configuration, two halves |
//! | 6, 7 | 0x081C_0000 | models, two slots |
//!
//! A flash word has 32 bytes and an error correction code. It is programmed once between two
//! erasures. A word whose programming was interrupted can fail the correction, and reading it is a
//! bus error. So [`is_readable`] reads with bus errors masked, before anything else does.
//!
//! The code is in bank 1, so the core runs while bank 2 is erased (at most 2 s, data sheet DS12110)
//! or programmed. A model of a package is in bank 2 and could not be read meanwhile. So flash is
//! written only while no run is on ([`controller::store::SlotMemory::stalls_the_core`]).

use stm32h7::stm32h743v::{FLASH, flash};

use controller::store::controller::{FlashPort, Status};

use super::caches;

/// Start of bank 2.
pub(in crate::boards) const ORIGIN: usize = 0x0810_0000;
/// First sector for the configuration.
pub(in crate::boards) const CONFIGURATION: u8 = 4;
/// First sector for the models.
pub(in crate::boards) const MODELS: u8 = 6;
/// True if a word must not be programmed twice.
pub(in crate::boards) const IS_WRITE_ONCE: bool = true;
const WORD_LENGTH: usize = 32;
/// Operations use 64 bits at a time: the fastest.
const PARALLELISM: u8 = 3;

/// Decides whether every flash word of a range can be read.
pub(in crate::boards) fn is_readable(start: usize, length: usize) -> bool {
    let first = start - start % WORD_LENGTH;
    let end = start.saturating_add(length);
    Port.clear_errors();
    let is_read = caches::read_masked((first..end).step_by(WORD_LENGTH));
    let is_corrected = !registers().sr().read().dbeccerr().bit_is_set();
    Port.clear_errors();
    is_read && is_corrected
}

/// The controller of flash bank 2. Only `idle` writes flash, one operation at a time. The clock
/// tree has set the wait states before.
pub(in crate::boards) struct Port;

fn registers() -> &'static flash::BANK {
    #[expect(unsafe_code, reason = "see `Port`: no other code uses these registers")]
    unsafe {
        (*FLASH::ptr()).bank2()
    }
}

/// Errors of writing: WRPERR, PGSERR, STRBERR, INCERR, OPERR.
const ERRORS: u32 = 0x006E_0000;
/// Errors of reading (RDPERR, RDSERR, SNECCERR, DBECCERR), and the end of an operation. Speculative
/// reads of the core set the first two although nothing is protected.
const OTHER_FLAGS: u32 = 0x0781_0000;

impl FlashPort for Port {
    const WORD_LENGTH: usize = WORD_LENGTH;

    fn status(&self) -> Status {
        let status = registers().sr().read();
        let is_busy = status.bsy().bit_is_set() || status.qw().bit_is_set();
        Status { busy: is_busy, errors: ((status.bits() & ERRORS) >> 16) as u16 }
    }

    fn clear_errors(&mut self) {
        registers().ccr().write(|w| {
            #[expect(unsafe_code, reason = "these bits clear flags, the others have no effect")]
            unsafe {
                w.bits(ERRORS | OTHER_FLAGS)
            }
        });
    }

    fn unlock(&mut self) -> bool {
        // Keys for an open controller would lock it until the next reset.
        if !registers().cr().read().lock().bit_is_set() {
            return true;
        }
        for key in [0x4567_0123, 0xCDEF_89AB] {
            registers().keyr().write(|w| {
                #[expect(unsafe_code, reason = "the two keys of the manual, in their order")]
                unsafe {
                    w.bits(key)
                }
            });
        }
        !registers().cr().read().lock().bit_is_set()
    }

    fn lock(&mut self) {
        registers().cr().modify(|_, w| w.lock().set_bit());
    }

    fn start_erase(&mut self, sector: u8) {
        registers().cr().modify(|_, w| {
            #[expect(unsafe_code, reason = "a sector number from 4 to 7")]
            let w = unsafe { w.snb().bits(sector & 7).psize().bits(PARALLELISM) };
            w.pg().clear_bit().ser().set_bit().ber().clear_bit()
        });
        registers().cr().modify(|_, w| w.start().set_bit());
        cortex_m::asm::dsb();
    }

    fn programming(&mut self, on: bool) {
        registers().cr().modify(|_, w| {
            #[expect(unsafe_code, reason = "a value of the manual")]
            let w = unsafe { w.psize().bits(PARALLELISM) };
            w.ser().clear_bit().pg().bit(on)
        });
        // A store that overtakes the bit is refused.
        cortex_m::asm::dsb();
    }

    fn store(&mut self, address: u32, word: u32) {
        #[expect(
            unsafe_code,
            reason = "the callers' ranges are inside the sectors for run-time data, words aligned"
        )]
        unsafe {
            (address as *mut u32).write_volatile(word);
        }
        cortex_m::asm::dsb();
    }

    fn flush(&mut self) {
        caches::flush();
    }
}
