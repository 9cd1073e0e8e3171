//! Devices on the sensor bus: mode 1, most significant bit first. Each device has a select pin.
//!
//! The converter is read at 17 MHz or less, the encoder at 10 MHz or less. A sample of three inputs
//! and the angle has 14 bytes. Every wait has a timeout: a transaction ends at the first byte that
//! does not arrive. The drivers detect an absent device.
//!
//! Source: AS5047P v1-11 (350 ns from select to clock, and between two selects).

use core::convert::Infallible;

use embedded_hal::digital::OutputPin;
use embedded_hal::spi::{Error, ErrorKind, ErrorType, Operation, SpiDevice};

use super::super::microcontroller::bus;

/// Divider of the bus clock with its register value.
#[derive(Clone, Copy, Debug)]
#[repr(u8)]
pub(in crate::boards) enum Divider {
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
pub(in crate::boards) fn split<A, B>(
    _port: bus::Registers,
    first: (A, Divider),
    second: (B, Divider),
) -> (Device<A>, Device<B>) {
    (Device { select: first.0, divider: first.1 }, Device { select: second.0, divider: second.1 })
}

fn serve(operation: &mut Operation<'_, u8>) -> Result<(), NoByte> {
    match operation {
        Operation::Read(bytes) => {
            bytes.iter_mut().try_for_each(|byte| bus::exchange(0).map(|received| *byte = received))
        }
        Operation::Write(bytes) => bytes.iter().try_for_each(|&byte| bus::exchange(byte).map(|_| ())),
        Operation::Transfer(read, write) => {
            for at in 0..read.len().max(write.len()) {
                let received = bus::exchange(write.get(at).copied().unwrap_or_default())?;
                if let Some(slot) = read.get_mut(at) {
                    *slot = received;
                }
            }
            Ok(())
        }
        Operation::TransferInPlace(bytes) => {
            bytes.iter_mut().try_for_each(|byte| bus::exchange(*byte).map(|received| *byte = received))
        }
        Operation::DelayNs(nanoseconds) => {
            cortex_m::asm::delay(bus::delay_cycles(*nanoseconds));
            Ok(())
        }
    }
}

impl<SELECT> ErrorType for Device<SELECT> {
    type Error = NoByte;
}

impl<SELECT: OutputPin<Error = Infallible>> SpiDevice for Device<SELECT> {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), NoByte> {
        bus::enable(self.divider);
        let _ = self.select.set_low();
        cortex_m::asm::delay(bus::SELECT_CYCLES);
        let served = operations.iter_mut().try_for_each(serve);
        let _ = self.select.set_high();
        cortex_m::asm::delay(bus::SELECT_CYCLES);
        served
    }
}
