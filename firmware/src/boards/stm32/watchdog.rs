//! The independent watchdog: an oscillator and a counter that reset the core unless they are
//! kicked.
//!
//! Once started, it cannot be stopped. [`controller::supervisor::Attendance`] detects a missing
//! party much earlier; the watchdog acts if not even that runs. Its timeout must outlast the
//! erasure of a flash sector, during which nothing kicks it (at most 2 s). The oscillator of the
//! STM32F405 has 17 to 47 kHz: nominal 4 s are 2.7 to 7.7 s. That of the STM32H743 has 32 kHz
//! within 10 %. A debugger's halt pauses the watchdog. The emulator has a dummy: the kicks have no
//! effect.

use super::super::microcontroller::pac::IWDG;

/// Prescaler 32: a count is nominally 1 ms.
const PRESCALER_32: u8 = 3;
/// Counts until a reset, less 1.
const RELOAD: u16 = 3_999;

const ACCESS: u16 = 0x5555;
const KICK: u16 = 0xAAAA;
const START: u16 = 0xCCCC;
/// Polls until new settings have reached the oscillator's domain: five of its periods, with margin.
const POLLS: u32 = 100_000;

/// The running watchdog.
pub struct Watchdog(IWDG);

impl Watchdog {
    /// Starts the watchdog.
    pub(in crate::boards) fn start(registers: IWDG) -> Self {
        let watchdog = Self(registers);
        watchdog.key(START);
        watchdog.key(ACCESS);
        #[expect(unsafe_code, reason = "raw values within the width of their fields")]
        unsafe {
            watchdog.0.pr().write(|w| w.bits(PRESCALER_32.into()));
            watchdog.0.rlr().write(|w| w.bits(RELOAD.into()));
        }
        // Until then the shorter default of 0.5 s counts. It is no error if this takes longer.
        let _ = (0..POLLS).any(|_| watchdog.0.sr().read().bits() == 0);
        watchdog.key(KICK);
        watchdog
    }

    /// Restarts the timeout.
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
