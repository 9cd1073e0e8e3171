//! The converter on the sensor bus for single transactions: mode 1, most significant bit first.
//!
//! Only its configuration is written so; samples are a sequence that hardware runs
//! ([`super::Acquisition`]). Every wait has a timeout: a transaction ends at the first byte that
//! does not arrive. The driver detects an absent device.

use embedded_hal::spi::{Error, ErrorKind, ErrorType, Operation, SpiDevice};

use super::super::microcontroller::bus;
use super::slot_timer::SlotTimer;

/// Error: a byte did not arrive in time.
#[derive(Clone, Copy, Debug)]
pub struct NoByte;

impl Error for NoByte {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

/// The converter, selected by the timer's output while the timer does not run.
pub struct Converter<'a> {
    timer: &'a SlotTimer,
}

impl<'a> Converter<'a> {
    /// Takes the bus for bytes. The timer must be stopped.
    pub(super) fn new(timer: &'a SlotTimer) -> Self {
        bus::enable_bytes();
        Self { timer }
    }
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

impl ErrorType for Converter<'_> {
    type Error = NoByte;
}

impl SpiDevice for Converter<'_> {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), NoByte> {
        self.timer.select_converter(true);
        cortex_m::asm::delay(bus::SELECT_CYCLES);
        let served = operations.iter_mut().try_for_each(serve);
        self.timer.select_converter(false);
        cortex_m::asm::delay(bus::SELECT_CYCLES);
        served
    }
}
