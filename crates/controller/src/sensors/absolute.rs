//! Frames of the ams AS5047P: absolute magnetic encoder, 14 bits a revolution, SPI mode 1, at most
//! 10 MHz.
//!
//! Framing (data sheet v1-11, section SPI interface): 16 bits, most significant first. To the
//! device: bit 15 even parity, bit 14 read, bits 13 to 0 the address. From the device: bit 15 even
//! parity, bit 14 the error flag of the *previous* frame, bits 13 to 0 the data of the address
//! requested in the previous frame, which the device samples when it is released.
//!
//! A sample has three frames. The first requests the angle. The second returns it and requests the
//! diagnostics; the third returns those and requests the error register. Reading that register
//! clears the error flag, so a disturbed frame costs one angle. Its content arrives with the next
//! sample and is not used.
//!
//! A line that is stuck at either level gives no angle: in the diagnostics the bit that marks the
//! end of the offset compensation is set, and the bit of an overflow of the angle's computation is
//! not.
//!
//! One step is 383 urad, twenty times the noise that the default bench assumes for its angle
//! sensor. The sliding speed of a slow shaft is then uncertain, and a shaft at rest shows one code.
//! Use a finer encoder where friction matters.

use super::SensorFault;
use super::sequence::EncoderAnswers;

/// Steps of a revolution.
pub(super) const STEPS: u32 = 1 << 14;
const READ: u16 = 1 << 14;
const ANGLE: u16 = 0x3fff;
const ERRORS: u16 = 0x0001;
const DIAGNOSTICS: u16 = 0x3ffc;
const ERROR_FLAG: u16 = 1 << 14;
const DATA: u16 = (1 << 14) - 1;

/// Offset compensation ended.
const COMPENSATED: u16 = 1 << 8;
/// Overflow of the angle's computation.
const OVERFLOW: u16 = 1 << 9;

/// Commands of a sample: for the angle, the diagnostics, the error register.
pub(super) const COMMANDS: [u16; 3] =
    [with_parity(READ | ANGLE), with_parity(READ | DIAGNOSTICS), with_parity(READ | ERRORS)];

/// Returns the angle in the answers of a sample, in steps.
///
/// # Errors
///
/// The line is stuck, a parity is wrong, or the device flags an error.
pub(super) const fn angle_steps(answers: &EncoderAnswers) -> Result<u16, SensorFault> {
    let (angle, diagnostics) = match (data(answers.angle), data(answers.diagnostics)) {
        (Ok(angle), Ok(diagnostics)) => (angle, diagnostics),
        (Err(fault), _) | (_, Err(fault)) => return Err(fault),
    };
    if diagnostics & COMPENSATED == 0 {
        Err(SensorFault::NoAnswer)
    } else if diagnostics & OVERFLOW != 0 {
        Err(SensorFault::ErrorFlag)
    } else {
        Ok(angle)
    }
}

/// Returns the data of an answer. All ones has even parity, but is what an open line reads.
const fn data(answer: u16) -> Result<u16, SensorFault> {
    if answer == u16::MAX {
        Err(SensorFault::NoAnswer)
    } else if !answer.count_ones().is_multiple_of(2) {
        Err(SensorFault::Parity)
    } else if answer & ERROR_FLAG != 0 {
        Err(SensorFault::ErrorFlag)
    } else {
        Ok(answer & DATA)
    }
}

/// Returns the frame with bit 15 set so that the number of ones is even.
const fn with_parity(frame: u16) -> u16 {
    frame | ((frame.count_ones() as u16) & 1) << 15
}
