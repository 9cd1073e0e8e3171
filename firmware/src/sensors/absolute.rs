//! ams AS5047P: absolute magnetic encoder, 14 bits a revolution, SPI mode 1, at most 10 MHz.
//!
//! Framing (data sheet v1-11, section SPI interface): 16 bits, most significant first. To the device: bit 15 even parity, bit 14 read, bits 13
//! to 0 the address. From the device: bit 15 even parity, bit 14 the error flag of the frame *before*, bits 13 to 0 the data of the
//! address asked for in the frame before. Asking for `ANGLECOM` in every frame, each answer is the angle sampled at the last select: one
//! sample period old, which is a delay of the angle by that period.
//!
//! An answer of all ones is no angle: it has even parity, but the error flag set; it is what an open line with a pull-up reads. All
//! zeros has even parity and no error flag, and is a true angle once in 16,384. It is taken for one only after the device has shown
//! that it is there, by any other answer; until then the device is asked for its diagnostics, which are not 0 once its offset compensation has ended.
//! A data line that is stuck low later cannot be told from a shaft that stands at 0 by one answer, and is found as stuck
//! ([`crate::estimator::Plausibility`]).
//!
//! One step is 383 urad, twenty times the noise that the default bench assumes of its angle sensor: the sliding speed of a slow shaft is
//! then uncertain, and a shaft that stands still shows one code. A finer encoder is the better choice where friction matters.

use embedded_hal::spi::SpiDevice;

use super::SensorFault;

/// Steps of a revolution.
pub(super) const STEPS: u32 = 1 << 14;
const READ: u16 = 1 << 14;
const ANGLE: u16 = 0x3fff;
const ERRORS: u16 = 0x0001;
const DIAGNOSTICS: u16 = 0x3ffc;
const ERROR_FLAG: u16 = 1 << 14;
const DATA: u16 = (1 << 14) - 1;

/// The encoder on its bus.
#[derive(Debug)]
pub struct As5047p<SPI> {
    spi: SPI,
    /// What the next frame asks for: the angle, or the error register, whose reading clears it.
    next: u16,
    /// What the next answer is about.
    asked: u16,
    /// Whether the device has said anything but zeros.
    seen: bool,
}

impl<SPI: SpiDevice> As5047p<SPI> {
    /// Takes the device. The first two readings have no angle yet.
    pub const fn new(spi: SPI) -> Self {
        Self { spi, next: ANGLE, asked: ERRORS, seen: false }
    }

    /// Reads the angle asked for by the frame before, in steps.
    ///
    /// # Errors
    ///
    /// The bus failed, parity is wrong, the device flags an error in the frame before (its register is then read, which clears it, in
    /// the next frame), or this answer is not an angle because of that.
    pub fn read(&mut self) -> Result<u16, SensorFault> {
        let command = with_parity(READ | self.next);
        let mut frame = command.to_be_bytes();
        let asked = core::mem::replace(&mut self.asked, self.next);
        self.next = ANGLE;
        if self.spi.transfer_in_place(&mut frame).is_err() {
            self.asked = ERRORS;
            return Err(SensorFault::Bus);
        }
        let answer = u16::from_be_bytes(frame);
        if answer == u16::MAX {
            return Err(SensorFault::NoAnswer);
        }
        if !answer.count_ones().is_multiple_of(2) {
            return Err(SensorFault::Parity);
        }
        if answer & ERROR_FLAG != 0 {
            self.next = ERRORS;
            return Err(SensorFault::ErrorFlag);
        }
        self.seen |= answer & DATA != 0;
        if asked != ERRORS && !self.seen {
            self.next = DIAGNOSTICS;
            return Err(SensorFault::NoAnswer);
        }
        if asked == ANGLE { Ok(answer & DATA) } else { Err(SensorFault::ErrorFlag) }
    }

    /// Gives the bus back.
    pub fn release(self) -> SPI {
        self.spi
    }
}

/// A frame with bit 15 such that the number of ones is even.
const fn with_parity(frame: u16) -> u16 {
    frame | ((frame.count_ones() as u16) & 1) << 15
}
