//! Registers of the sensor bus: SPI2, PB13 clock, PB14 in, PB15 out.
//!
//! The peripheral's clock is 42 MHz with the PLL: the converter is read at 10.5 MHz, the encoder at
//! 5.25 MHz. The clocks of a sample take 12 us. Source: RM0090 section 28 (SPI).

use stm32f4xx_hal::pac::SPI2;

use crate::boards::stm32::spi::{Divider, NoByte};

/// Polls for a byte: four byte times of the slower device at 168 MHz.
const POLLS: u32 = 200;
/// Clock phase: the second edge samples.
const PHASE: u16 = 1;
const CONTROLLER: u16 = 1 << 2;
const ENABLE: u16 = 1 << 6;
/// The select input is held high internally; it is not a pin.
const SELECT_INSIDE: u16 = 1 << 8 | 1 << 9;
/// Position of the divider's bits.
const DIVIDER: u32 = 3;

/// Core cycles in 350 ns at 168 MHz; a slower core waits longer than necessary.
pub(in crate::boards) const SELECT_CYCLES: u32 = 60;

/// Registers of the port.
pub(in crate::boards) type Registers = SPI2;

fn port() -> &'static stm32f4xx_hal::pac::spi1::RegisterBlock {
    #[expect(unsafe_code, reason = "the devices own the port, and one task owns the devices")]
    unsafe {
        &*SPI2::ptr()
    }
}

/// Returns core cycles of at least this time; a cycle is at least 1/168 us.
pub(in crate::boards) const fn delay_cycles(nanoseconds: u32) -> u32 {
    (nanoseconds / 5).saturating_add(1)
}

/// Enables the port with a divider.
pub(in crate::boards) fn enable(divider: Divider) {
    let settings = PHASE | CONTROLLER | SELECT_INSIDE | (divider as u16) << DIVIDER;
    for bits in [settings, settings | ENABLE] {
        port().cr1().write(|w| {
            #[expect(unsafe_code, reason = "the whole register in one: its bits are named above")]
            unsafe {
                w.bits(bits)
            }
        });
    }
}

/// Sends a byte and returns the byte received at the same time.
pub(in crate::boards) fn exchange(byte: u8) -> Result<u8, NoByte> {
    let port = port();
    port.dr().write(|w| {
        #[expect(unsafe_code, reason = "a raw data byte")]
        unsafe {
            w.bits(byte.into())
        }
    });
    let received = (0..POLLS).any(|_| port.sr().read().rxne().bit_is_set());
    let [low, ..] = port.dr().read().bits().to_le_bytes();
    if received { Ok(low) } else { Err(NoByte) }
}
