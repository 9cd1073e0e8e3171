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

use controller::store::controller::{FlashPort, Status};

/// Start of sector 0 if all sectors had the size of sector 5 and up.
pub(in crate::boards) const ORIGIN: usize = 0x0800_0000 - 4 * 128 * 1024;
/// First sector for the configuration.
pub(in crate::boards) const CONFIGURATION: u8 = 8;
/// First sector for the models.
pub(in crate::boards) const MODELS: u8 = 10;
/// True if a word must not be programmed twice.
pub(in crate::boards) const IS_WRITE_ONCE: bool = false;

/// Decides whether every byte can be read: this flash has no error correction that fails.
pub(in crate::boards) const fn is_readable(_start: usize, _length: usize) -> bool {
    true
}

/// The flash controller. Only `idle` writes flash, one operation at a time. The clock tree has set
/// the wait states before.
pub(in crate::boards) struct Port;

fn registers() -> &'static stm32f4xx_hal::pac::flash::RegisterBlock {
    #[expect(unsafe_code, reason = "see `Port`: no other code uses these registers")]
    unsafe {
        &*FLASH::ptr()
    }
}

impl FlashPort for Port {
    const WORD_LENGTH: usize = 4;

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
