//! Registers of the sensor bus: SPI1, PA5 clock, PA6 in, PB5 out.
//!
//! The peripheral's clock is the internal oscillator of 64 MHz, whatever the core runs on: the
//! converter is read at 16 MHz, the encoder at 8 MHz. The clocks of a sample take 8 us. Source:
//! RM0433 section 50 (SPI).

use stm32h7::stm32h743v::{SPI1, spi1};

use crate::boards::stm32::spi::{Divider, NoByte};

/// Polls for a byte: at least four byte times of the slower device at 480 MHz and 5 cycles a poll.
const POLLS: u32 = 400;

/// Core cycles in 350 ns at 480 MHz. The wait has a loop of at least one cycle for each. A slower
/// core waits longer than necessary.
pub(in crate::boards) const SELECT_CYCLES: u32 = 168;

/// Registers of the port.
pub(in crate::boards) type Registers = SPI1;

fn port() -> &'static spi1::RegisterBlock {
    #[expect(unsafe_code, reason = "the devices own the port, and one task owns the devices")]
    unsafe {
        &*SPI1::ptr()
    }
}

/// Returns core cycles of at least this time; a cycle is at least 1/480 us.
pub(in crate::boards) const fn delay_cycles(nanoseconds: u32) -> u32 {
    (nanoseconds / 2).saturating_add(1)
}

/// Enables the port with a divider. Stops it first, which the registers require.
pub(in crate::boards) fn enable(divider: Divider) {
    /// Bits of a byte, less 1.
    const BYTE: u8 = 7;
    let port = port();
    // The last transaction has ended with its last byte, or has been given up.
    port.cr1().write(|w| w.ssi().set_bit());
    port.ifcr().write(|w| {
        let w = w.eotc().clear_bit_by_one().txtfc().clear_bit_by_one();
        w.ovrc().clear_bit_by_one().suspc().clear_bit_by_one().modfc().clear_bit_by_one()
    });
    port.cfg1().write(|w| {
        let w = w.dsize().set(BYTE);
        match divider {
            Divider::Four => w.mbr().div4(),
            Divider::Eight => w.mbr().div8(),
        }
    });
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
