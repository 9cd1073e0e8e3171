//! Scripts for a bus.

use embedded_hal::spi::ErrorKind;
use embedded_hal_mock::eh1::spi::Transaction;

/// A transaction of a whole frame: what is sent and what comes back.
pub(crate) fn frame(sent: &[u8], answer: &[u8]) -> [Transaction<u8>; 3] {
    [
        Transaction::transaction_start(),
        Transaction::transfer_in_place(sent.to_vec(), answer.to_vec()),
        Transaction::transaction_end(),
    ]
}

/// A conversion frame of the ADS8688: selects an input, returns a code.
pub(crate) fn conversion(next: u8, code: u16) -> [Transaction<u8>; 3] {
    let [high, low] = code.to_be_bytes();
    frame(&[0xc0 | next << 2, 0, 0, 0], &[0, 0, high, low])
}

/// A frame of the AS5047P: the command of an angle or of the error register, and an answer.
pub(crate) fn encoder(command: u16, answer: u16) -> [Transaction<u8>; 3] {
    frame(&command.to_be_bytes(), &answer.to_be_bytes())
}

/// Asks for the angle: read, 0x3fff, fifteen ones and so the parity bit.
pub(crate) const ASK_ANGLE: u16 = 0xffff;
/// Asks for the error register: read, 0x0001, two ones and no parity bit.
pub(crate) const ASK_ERRORS: u16 = 0x4001;

/// Asks for the diagnostics: read, 0x3ffc, thirteen ones and so the parity bit.
pub(crate) const ASK_DIAGNOSTICS: u16 = 0xfffc;

/// A bus that fails.
#[derive(Debug)]
pub(crate) struct Broken;

#[derive(Debug)]
pub(crate) struct Failure;

impl embedded_hal::spi::Error for Failure {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

impl embedded_hal::spi::ErrorType for Broken {
    type Error = Failure;
}

impl embedded_hal::spi::SpiDevice for Broken {
    fn transaction(&mut self, _: &mut [embedded_hal::spi::Operation<'_, u8>]) -> Result<(), Failure> {
        Err(Failure)
    }
}
