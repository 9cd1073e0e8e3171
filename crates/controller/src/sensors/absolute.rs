//! Driver of the ams AS5047P: absolute magnetic encoder, 14 bits a revolution, SPI mode 1, at most
//! 10 MHz.
//!
//! Framing (data sheet v1-11, section SPI interface): 16 bits, most significant first. To the
//! device: bit 15 even parity, bit 14 read, bits 13 to 0 the address. From the device: bit 15 even
//! parity, bit 14 the error flag of the *previous* frame, bits 13 to 0 the data of the address
//! requested in the previous frame. Every frame requests `ANGLECOM`, so each answer is the angle
//! sampled at the last select: a delay of one sample period.
//!
//! An answer of all ones is not an angle: it has even parity, but the error flag set. An open line
//! with a pull-up reads so. All zeros has even parity and no error flag, and is a true angle once
//! in 16,384. It is accepted only after the device has given any other answer. Until then the
//! device is asked for its diagnostics, which are not 0 once its offset compensation has ended. One
//! answer cannot distinguish a data line that is stuck low later from a shaft at angle 0;
//! [`crate::estimator::Plausibility`] finds it as stuck.
//!
//! One step is 383 urad, twenty times the noise that the default bench assumes for its angle
//! sensor. The sliding speed of a slow shaft is then uncertain, and a shaft at rest shows one code.
//! Use a finer encoder where friction matters.

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

/// Encoder on its bus.
#[derive(Debug)]
pub struct As5047p<SPI> {
    spi: SPI,
    /// Address in the next frame: the angle, or the error register, which reading clears.
    next: u16,
    /// Address of the register that the next answer contains.
    requested: u16,
    /// `true` once the device has answered anything but zeros.
    seen: bool,
}

impl<SPI: SpiDevice> As5047p<SPI> {
    /// Takes the device. The first two readings have no angle yet.
    pub const fn new(spi: SPI) -> Self {
        Self { spi, next: ANGLE, requested: ERRORS, seen: false }
    }

    /// Reads the angle that the previous frame requested, in steps.
    ///
    /// # Errors
    ///
    /// The bus failed, the parity is wrong, or the device flags an error in the previous frame. In
    /// the last case the next frame reads the error register, which clears it, and the answer after
    /// it is no angle.
    pub fn read(&mut self) -> Result<u16, SensorFault> {
        let command = with_parity(READ | self.next);
        let mut frame = command.to_be_bytes();
        let requested = core::mem::replace(&mut self.requested, self.next);
        self.next = ANGLE;
        if self.spi.transfer_in_place(&mut frame).is_err() {
            self.requested = ERRORS;
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
        if requested != ERRORS && !self.seen {
            self.next = DIAGNOSTICS;
            return Err(SensorFault::NoAnswer);
        }
        if requested == ANGLE { Ok(answer & DATA) } else { Err(SensorFault::ErrorFlag) }
    }

    /// Returns the bus.
    pub fn release(self) -> SPI {
        self.spi
    }
}

/// Returns the frame with bit 15 set so that the number of ones is even.
const fn with_parity(frame: u16) -> u16 {
    frame | ((frame.count_ones() as u16) & 1) << 15
}
