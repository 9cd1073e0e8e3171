//! The last four flash sectors, 128 KiB each, for data that is written at run time (RM0090 table 5,
//! section 3.6).
//!
//! | sectors | address | content |
//! |---|---|---|
//! | 8, 9 | 0x0808_0000 | configuration, two halves |
//! | 10, 11 | 0x080C_0000 | models, two slots |
//!
//! There is one bank. While a sector is erased (1 s, at most 2 s) or a word is programmed (16 us,
//! at most 100 us), every fetch from flash stalls, interrupts included. So flash is written only
//! while no run is on ([`controller::store::SlotMemory::stalls_the_core`]). Words of 32 bits
//! require a supply of 2.7 V or more.

use stm32f4xx_hal::pac::FLASH;

use controller::store::controller::{FlashError, FlashPort, Status, erase, program};

const SECTOR_BYTES: usize = 128 * 1024;
const FLASH_START: usize = 0x0800_0000;
/// Sector number that corresponds to offset 0 in units of 128 KiB: sectors 5 and up have this size.
const FIRST_LARGE: u8 = 4;

/// Two adjacent sectors.
#[derive(Debug)]
pub(in crate::boards) struct Sectors {
    first: u8,
}

impl Sectors {
    /// Length of a flash word, bytes.
    pub(in crate::boards) const WORD_LENGTH: usize = 4;
    /// True if a word must not be programmed twice.
    pub(in crate::boards) const IS_WRITE_ONCE: bool = false;

    pub(in crate::boards) const CONFIGURATION: Self = Self { first: 8 };
    pub(in crate::boards) const MODELS: Self = Self { first: 10 };

    pub(in crate::boards) const fn start(&self) -> usize {
        FLASH_START.wrapping_add((self.first.wrapping_sub(FIRST_LARGE) as usize).wrapping_mul(SECTOR_BYTES))
    }

    pub(in crate::boards) const fn length(&self) -> usize {
        2 * SECTOR_BYTES
    }

    /// Decides whether every byte can be read: this flash has no error correction that fails.
    pub(in crate::boards) const fn is_readable(&self, _start: usize, _length: usize) -> bool {
        true
    }

    /// Erases complete sectors.
    pub(in crate::boards) fn erase(&mut self, start: usize, length: usize) -> Result<(), FlashError> {
        let offset = start.checked_sub(self.start()).ok_or(FlashError::OutOfBounds)?;
        if !offset.is_multiple_of(SECTOR_BYTES) || !length.is_multiple_of(SECTOR_BYTES) {
            return Err(FlashError::NotAligned);
        }
        let [from, count] = [offset / SECTOR_BYTES, length / SECTOR_BYTES].map(|number| number as u8);
        let first = self.first.saturating_add(from);
        (first..first.saturating_add(count)).try_for_each(|sector| erase(&mut Port, sector))
    }

    /// Programs words.
    pub(in crate::boards) fn program(&mut self, address: usize, bytes: &[u8]) -> Result<(), FlashError> {
        program(&mut Port, address as u32, bytes)
    }
}

/// The flash controller. Only `idle` writes flash, one operation at a time. The clock tree has set
/// the wait states before.
struct Port;

fn registers() -> &'static stm32f4xx_hal::pac::flash::RegisterBlock {
    #[expect(unsafe_code, reason = "see `Port`: no other code uses these registers")]
    unsafe {
        &*FLASH::ptr()
    }
}

impl FlashPort for Port {
    const WORD_LENGTH: usize = Sectors::WORD_LENGTH;

    fn status(&self) -> Status {
        let status = registers().sr().read();
        // OPERR, WRPERR, PGAERR, PGPERR, PGSERR.
        Status { busy: status.bsy().bit_is_set(), errors: status.bits() as u16 & 0b1111_0010 }
    }

    fn clear_errors(&mut self) {
        registers().sr().write(|w| {
            #[expect(
                unsafe_code,
                reason = "the error bits and the end of operation are cleared by writing 1"
            )]
            unsafe {
                w.bits(0b1111_0011)
            }
        });
    }

    fn unlock(&mut self) -> bool {
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
            #[expect(unsafe_code, reason = "a sector number from 8 to 11")]
            let w = unsafe { w.snb().bits(sector) };
            w.psize().psize32().pg().clear_bit().ser().set_bit().mer().clear_bit()
        });
        registers().cr().modify(|_, w| w.strt().set_bit());
        cortex_m::asm::dsb();
    }

    fn programming(&mut self, on: bool) {
        registers().cr().modify(|_, w| w.psize().psize32().ser().clear_bit().pg().bit(on));
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
        let acr = registers().acr();
        let on = acr.read().dcen().bit_is_set();
        acr.modify(|_, w| w.dcen().clear_bit());
        acr.modify(|_, w| w.dcrst().set_bit());
        acr.modify(|_, w| w.dcrst().clear_bit());
        acr.modify(|_, w| w.dcen().bit(on));
    }
}
