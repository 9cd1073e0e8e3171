//! Registers of the samples: SPI2 (PB13 clock, PB14 in, PB15 out), TIM4 (PB8, PB9 selects), TIM5
//! and DMA1.
//!
//! The bus runs at 5.25 MHz with the PLL. All peripherals are on one bus of the microcontroller and
//! all streams are of DMA1: DMA2 can corrupt data when it serves a GPIO port and the peripherals'
//! bus at a time (errata sheet ES0182, section 2.1.10). Sources: RM0090 section 28 (SPI), table 42
//! (requests of DMA1).

use controller::sensors::Device;
use stm32f4xx_hal::pac::{DMA1, SPI2, TIM4, TIM5};

use crate::boards::stm32::NoByte;

/// Polls for a byte: at least four byte times at 168 MHz.
const POLLS: u32 = 400;
/// Clock phase: the second edge samples.
const PHASE: u16 = 1;
const CONTROLLER: u16 = 1 << 2;
/// The bus clock is that of the peripheral over 8.
const DIVIDE_BY_8: u16 = 2 << 3;
const ENABLE: u16 = 1 << 6;
/// The select input is held high internally; it is not a pin.
const SELECT_INSIDE: u16 = 1 << 8 | 1 << 9;
const WORDS: u16 = 1 << 11;

/// Core cycles in 350 ns at 168 MHz; a slower core waits longer than necessary.
pub(in crate::boards) const SELECT_CYCLES: u32 = 60;

/// Clock of the bus over that of the peripheral.
pub(super) const BUS_DIVIDER: u32 = 8;
/// Divider of the slots' timer.
pub(in crate::boards) const SLOT_DIVIDER: u32 = 1;
/// Device at output 3 of the slots' timer: PB8.
pub(in crate::boards) const SELECT_3: Device = Device::Encoder;
/// Returns the address of the slots' timer.
pub(in crate::boards) fn slot_timer() -> usize {
    TIM4::ptr() as usize
}

/// Returns the address of the time base.
pub(in crate::boards) fn time_base() -> usize {
    TIM5::ptr() as usize
}

/// Returns the address of the DMA controller.
pub(in crate::boards) fn dma() -> usize {
    DMA1::ptr() as usize
}

/// Returns the address that words arrive at.
pub(in crate::boards) fn data_in() -> u32 {
    port().dr().as_ptr() as u32
}

/// Returns the address that words are sent from.
pub(in crate::boards) fn data_out() -> u32 {
    port().dr().as_ptr() as u32
}

fn port() -> &'static stm32f4xx_hal::pac::spi1::RegisterBlock {
    #[expect(unsafe_code, reason = "the acquisition owns the port, and one task owns that")]
    unsafe {
        &*SPI2::ptr()
    }
}

/// Returns core cycles of at least this time; a cycle is at least 1/168 us.
pub(in crate::boards) const fn delay_cycles(nanoseconds: u32) -> u32 {
    (nanoseconds / 5).saturating_add(1)
}

/// Field of a stream's control register that selects its request: SPI2 receives (channel 0); TIM4
/// (channel 2).
pub(in crate::boards) const fn channel(stream: u32) -> u32 {
    match stream {
        3 => 0,
        _ => 2 << 25,
    }
}

/// Enables the port for single bytes.
pub(in crate::boards) fn enable_bytes() {
    enable(0, false);
}

/// Enables the port for words that DMA sends and receives.
pub(in crate::boards) fn enable_words() {
    enable(WORDS, true);
}

/// Disables the port and drops what it has received.
pub(in crate::boards) fn disable() {
    let port = port();
    port.cr2().write(|w| w.rxdmaen().clear_bit());
    // A word may be on its way, or wait.
    let _ = (0..POLLS).any(|_| {
        let status = port.sr().read();
        status.txe().bit_is_set() && status.bsy().bit_is_clear()
    });
    port.cr1().modify(|_, w| w.spe().clear_bit());
    let _ = (port.dr().read().bits(), port.sr().read().bits());
}

/// Enables the port. Disables it first, because the format changes only then.
fn enable(format: u16, is_received_by_dma: bool) {
    disable();
    let port = port();
    let settings = PHASE | CONTROLLER | DIVIDE_BY_8 | SELECT_INSIDE | format;
    port.cr2().write(|w| w.rxdmaen().bit(is_received_by_dma));
    for bits in [settings, settings | ENABLE] {
        port.cr1().write(|w| {
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
