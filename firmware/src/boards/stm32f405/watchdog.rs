//! The independent watchdog: an oscillator and a counter of its own that reset the core unless they are kicked.
//!
//! Started once, it cannot be stopped. [`crate::supervisor::Attendance`] is much quicker to notice somebody missing; this is for when not even
//! that runs. Its time must outlast the erasure of a flash sector, in which the core stands still (2 s at most, data sheet table 41).
//! The oscillator is 17 to 47 kHz: 4 s nominal are 2.7 to 7.7 s. It stands still while a debugger has halted the core. The emulator has a
//! dummy in its place: the kicks go nowhere.

use stm32f4xx_hal::pac::{DBGMCU, IWDG};

/// Prescaler 32: a count is 1 ms nominally.
const PRESCALER_32: u8 = 3;
/// Counts to a reset, less 1.
const RELOAD: u16 = 3_999;

const ACCESS: u16 = 0x5555;
const KICK: u16 = 0xAAAA;
const START: u16 = 0xCCCC;
/// Polls for the new settings to cross into the oscillator's domain: five of its periods, with margin.
const POLLS: u32 = 100_000;

/// The running watchdog.
pub struct Watchdog(IWDG);

impl Watchdog {
    /// Starts it.
    pub(in crate::boards) fn start(registers: IWDG, debug: &DBGMCU) -> Self {
        debug.apb1_fz().modify(|_, w| w.dbg_iwdg_stop().set_bit());
        let watchdog = Self(registers);
        watchdog.key(START);
        watchdog.key(ACCESS);
        #[expect(unsafe_code, reason = "raw fields within their width")]
        unsafe {
            watchdog.0.pr().write(|w| w.pr().bits(PRESCALER_32));
            watchdog.0.rlr().write(|w| w.rl().bits(RELOAD));
        }
        // Until they have crossed, the shorter default counts: 0.5 s. Not an error if it takes longer.
        let _ = (0..POLLS).any(|_| watchdog.0.sr().read().bits() == 0);
        watchdog.key(KICK);
        watchdog
    }

    /// Puts the reset off.
    pub fn kick(&mut self) {
        self.key(KICK);
    }

    fn key(&self, key: u16) {
        self.0.kr().write(|w| {
            #[expect(unsafe_code, reason = "one of the three keys")]
            unsafe {
                w.bits(key.into())
            }
        });
    }
}
