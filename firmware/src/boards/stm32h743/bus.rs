//! Registers of the samples: SPI1 (PA5 clock, PA6 in, PB5 out), TIM4 (PD14, PD15 selects), TIM5 and
//! DMA2.
//!
//! The clock of SPI1 is the internal oscillator of 64 MHz, whatever the core runs on; the bus runs
//! at 8 MHz. Sources: RM0433 section 50 (SPI), table 121 (requests).

use controller::sensors::Device;
use stm32h7::stm32h743v::{DMA2, DMAMUX1, SPI1, TIM4, TIM5, spi1};

use crate::boards::stm32::NoByte;

/// Polls for a byte: at least four byte times at 480 MHz and 5 cycles a poll.
const POLLS: u32 = 400;

/// Core cycles in 350 ns at 480 MHz. The wait has a loop of at least one cycle for each. A slower
/// core waits longer than necessary.
pub(in crate::boards) const SELECT_CYCLES: u32 = 168;

/// Clock of the bus, Hz.
pub(super) const BUS_HZ: u32 = 8_000_000;
/// Divider of the slots' timer.
pub(in crate::boards) const SLOT_DIVIDER: u32 = 2;
/// Device at output 3 of the slots' timer: PD14.
pub(in crate::boards) const SELECT_3: Device = Device::Converter;
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
    DMA2::ptr() as usize
}

/// Returns the address that words arrive at.
pub(in crate::boards) fn data_in() -> u32 {
    port().rxdr16().as_ptr() as u32
}

/// Returns the address that words are sent from.
pub(in crate::boards) fn data_out() -> u32 {
    port().txdr16().as_ptr() as u32
}

fn port() -> &'static spi1::RegisterBlock {
    #[expect(unsafe_code, reason = "the acquisition owns the port, and one task owns that")]
    unsafe {
        &*SPI1::ptr()
    }
}

/// Returns core cycles of at least this time; a cycle is at least 1/480 us.
pub(in crate::boards) const fn delay_cycles(nanoseconds: u32) -> u32 {
    (nanoseconds / 2).saturating_add(1)
}

/// Field of a stream's control register that selects its request: none, see [`connect`].
pub(in crate::boards) const fn channel(_stream: u32) -> u32 {
    0
}

/// Connects the streams of DMA2 to their requests.
pub(super) fn connect(requests: &DMAMUX1) {
    /// Channel of stream 0 of DMA2.
    const FIRST: usize = 8;
    requests.ccr(FIRST).write(|w| w.dmareq_id().tim4_ch1());
    requests.ccr(FIRST + 3).write(|w| w.dmareq_id().spi1_rx_dma());
    requests.ccr(FIRST + 6).write(|w| w.dmareq_id().tim4_up());
}

/// Enables the port for single bytes.
pub(in crate::boards) fn enable_bytes() {
    enable(8, false);
}

/// Enables the port for words that DMA sends and receives.
pub(in crate::boards) fn enable_words() {
    enable(16, true);
}

/// Disables the port, which empties its buffers.
pub(in crate::boards) fn disable() {
    let port = port();
    // A word that is on its way is given up.
    port.cr1().write(|w| w.ssi().set_bit());
    port.cfg1().modify(|_, w| w.rxdmaen().clear_bit());
    port.ifcr().write(|w| {
        let w = w.eotc().clear_bit_by_one().txtfc().clear_bit_by_one();
        w.ovrc().clear_bit_by_one().suspc().clear_bit_by_one().modfc().clear_bit_by_one()
    });
}

/// Enables the port. Disables it first, because its settings change only then.
fn enable(bits: u8, is_received_by_dma: bool) {
    disable();
    let port = port();
    port.cfg1()
        .write(|w| w.dsize().set(bits.saturating_sub(1)).mbr().div8().rxdmaen().bit(is_received_by_dma));
    // The select input is held high internally; the clock stays low while the port is off.
    port.cfg2().write(|w| w.master().set_bit().cpha().set_bit().ssm().set_bit().afcntr().set_bit());
    // A transfer without a given length: it ends when the port stops.
    port.cr2().write(|w| w.tsize().set(0));
    port.cr1().write(|w| w.ssi().set_bit().spe().set_bit());
    port.cr1().write(|w| w.ssi().set_bit().spe().set_bit().cstart().set_bit());
}

/// Sends a byte and returns the byte received at the same time.
pub(in crate::boards) fn exchange(byte: u8) -> Result<u8, NoByte> {
    let port = port();
    port.txdr8().write(|w| w.txdr().set(byte));
    let received = (0..POLLS).any(|_| port.sr().read().rxp().bit_is_set());
    let received_byte = port.rxdr8().read().rxdr().bits();
    if received { Ok(received_byte) } else { Err(NoByte) }
}
