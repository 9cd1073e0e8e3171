//! The sensor bus: SPI2, PB13 clock, PB14 in, PB15 out, mode 1, most significant bit first. Each
//! device has a select pin.
//!
//! The peripheral's clock is 42 MHz with the PLL: the converter is read at 10.5 MHz (at most 17),
//! the encoder at 5.25 MHz (at most 10). A sample of three inputs and the angle has 14 bytes, 12 us
//! of clocks. Every wait has a timeout: a transaction ends at the first byte that does not arrive.
//! The drivers detect an absent device.
//!
//! Sources: RM0090 section 28 (SPI); AS5047P v1-11 (350 ns from select to clock, and between two
//! selects).

use core::convert::Infallible;

use embedded_hal::digital::OutputPin;
use embedded_hal::spi::{Error, ErrorKind, ErrorType, Operation, SpiDevice};
use stm32f4xx_hal::pac::SPI2;

/// Polls for a byte: four byte times of the slower device at 168 MHz.
const POLLS: u32 = 200;
/// Core cycles in 350 ns at 168 MHz; a slower core waits longer than necessary.
const SELECT_CYCLES: u32 = 60;
/// Clock phase: the second edge samples.
const PHASE: u16 = 1;
const CONTROLLER: u16 = 1 << 2;
const ENABLE: u16 = 1 << 6;
/// The select input is held high internally; it is not a pin.
const SELECT_INSIDE: u16 = 1 << 8 | 1 << 9;
/// Position of the divider's bits.
const DIVIDER: u32 = 3;

/// Divider of the bus clock with its register value.
#[derive(Clone, Copy, Debug)]
#[repr(u16)]
pub(super) enum Divider {
    /// Division by 4.
    Four = 1,
    /// Division by 8.
    Eight = 2,
}

/// Error: a byte did not arrive in time.
#[derive(Clone, Copy, Debug)]
pub struct NoByte;

impl Error for NoByte {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

/// A device on the bus. One task uses all of them.
pub struct Device<SELECT> {
    select: SELECT,
    divider: Divider,
}

/// Creates the devices of both selects, once. The port's clock and pins must be enabled, the
/// selects high.
pub(super) fn split<A, B>(_port: SPI2, first: (A, Divider), second: (B, Divider)) -> (Device<A>, Device<B>) {
    (Device { select: first.0, divider: first.1 }, Device { select: second.0, divider: second.1 })
}

fn port() -> &'static stm32f4xx_hal::pac::spi1::RegisterBlock {
    #[expect(unsafe_code, reason = "the devices own the port, and one task owns the devices")]
    unsafe {
        &*SPI2::ptr()
    }
}

/// Sends a byte and returns the byte received at the same time.
fn exchange(byte: u8) -> Result<u8, NoByte> {
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

fn serve(operation: &mut Operation<'_, u8>) -> Result<(), NoByte> {
    match operation {
        Operation::Read(bytes) => {
            bytes.iter_mut().try_for_each(|byte| exchange(0).map(|received| *byte = received))
        }
        Operation::Write(bytes) => bytes.iter().try_for_each(|&byte| exchange(byte).map(|_| ())),
        Operation::Transfer(read, write) => {
            for at in 0..read.len().max(write.len()) {
                let received = exchange(write.get(at).copied().unwrap_or_default())?;
                if let Some(slot) = read.get_mut(at) {
                    *slot = received;
                }
            }
            Ok(())
        }
        Operation::TransferInPlace(bytes) => {
            bytes.iter_mut().try_for_each(|byte| exchange(*byte).map(|received| *byte = received))
        }
        Operation::DelayNs(nanoseconds) => {
            // A cycle is at least 1/168 us; a longer wait than requested is allowed.
            cortex_m::asm::delay((*nanoseconds / 5).saturating_add(1));
            Ok(())
        }
    }
}

impl<SELECT> ErrorType for Device<SELECT> {
    type Error = NoByte;
}

impl<SELECT: OutputPin<Error = Infallible>> SpiDevice for Device<SELECT> {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), NoByte> {
        let settings = PHASE | CONTROLLER | SELECT_INSIDE | (self.divider as u16) << DIVIDER;
        for bits in [settings, settings | ENABLE] {
            port().cr1().write(|w| {
                #[expect(unsafe_code, reason = "the whole register in one: its bits are named above")]
                unsafe {
                    w.bits(bits)
                }
            });
        }
        let _ = self.select.set_low();
        cortex_m::asm::delay(SELECT_CYCLES);
        let served = operations.iter_mut().try_for_each(serve);
        let _ = self.select.set_high();
        cortex_m::asm::delay(SELECT_CYCLES);
        served
    }
}
