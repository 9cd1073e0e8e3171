//! Driver of the Texas Instruments ADS8688: eight channels, 16 bits, 500 kS/s, SPI mode 1, at most
//! 17 MHz.
//!
//! Framing (data sheet SBAS582C, sections 8.4 and 8.5). A conversion frame has 32 clocks: 16 for
//! the command, during which the device drives its output low, then 16 for the result, most
//! significant bit first. The command `MAN_Ch_n` (`0xC000 + n 0x400`) selects the channel that the
//! *next* frame converts and returns. Writing a program register takes 24 clocks: the address in
//! the upper 7 bits, a 1 for writing, and the value, which the device returns in the last 8.
//!
//! Results are straight binary: 0 is the lower end of the range, 65535 the upper.

use embedded_hal::spi::SpiDevice;

use link::InputRange;

use super::SensorFault;

/// Number of inputs of the device.
pub(crate) const INPUTS: u8 = 8;
const MANUAL: u16 = 0xc000;
const RESET: u16 = 0x8500;
const FIRST_RANGE_REGISTER: u8 = 0x05;

/// Converter on its bus, for its configuration. Samples are words of a
/// [`Sequence`](super::Sequence).
#[derive(Debug)]
pub struct Ads8688<SPI> {
    spi: SPI,
}

impl<SPI: SpiDevice> Ads8688<SPI> {
    /// Takes the device. Call [`Self::configure`] next.
    pub const fn new(spi: SPI) -> Self {
        Self { spi }
    }

    /// Resets the device, sets the range of each listed input and selects the first one for the
    /// next frame.
    ///
    /// # Errors
    ///
    /// The bus failed, or a register did not read back.
    pub fn configure(&mut self, ranges: &[(u8, InputRange)]) -> Result<(), SensorFault> {
        self.command(RESET)?;
        for (input, range) in ranges {
            let address = FIRST_RANGE_REGISTER.wrapping_add(input % INPUTS) << 1 | 1;
            let mut frame = [address, *range as u8, 0];
            self.spi.transfer_in_place(&mut frame).map_err(|_| SensorFault::Bus)?;
            let [.., echo] = frame;
            if echo != *range as u8 {
                return Err(SensorFault::NotConfigured);
            }
        }
        ranges.first().map_or(Ok(()), |(input, _)| self.select(*input))
    }

    /// Selects an input for the next frame.
    ///
    /// # Errors
    ///
    /// The bus failed, or the device did not drive its output low during the command.
    fn select(&mut self, next: u8) -> Result<(), SensorFault> {
        let [command, _] = frame_of(next);
        self.command(command)
    }

    fn command(&mut self, command: u16) -> Result<(), SensorFault> {
        let [high, low] = command.to_be_bytes();
        let mut frame = [high, low, 0, 0];
        self.spi.transfer_in_place(&mut frame).map_err(|_| SensorFault::Bus)?;
        let [high, low, ..] = frame;
        if [high, low] == [0, 0] { Ok(()) } else { Err(SensorFault::NoAnswer) }
    }
}

/// Returns the words of a conversion frame that selects the input of the next one.
pub(super) const fn frame_of(next: u8) -> [u16; 2] {
    [MANUAL | ((next % INPUTS) as u16) << 10, 0]
}

/// Returns the code in the words that answer a conversion frame.
///
/// # Errors
///
/// The device did not drive its output low during the command.
pub(super) const fn code(answer: [u16; 2]) -> Result<u16, SensorFault> {
    match answer {
        [0, code] => Ok(code),
        _ => Err(SensorFault::NoAnswer),
    }
}
