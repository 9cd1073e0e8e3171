//! Bus of the sensors as the sampler uses it.

use embedded_hal::spi::SpiDevice;

use super::sequence::Sequence;

/// Bus on which hardware runs a sequence of words at each tick of the sample timer.
pub trait SensorBus {
    /// The converter, for single transactions.
    type Converter<'a>: SpiDevice
    where
        Self: 'a;

    /// Stops the sequence and lends the converter.
    fn converter(&mut self) -> Self::Converter<'_>;

    /// Runs a sequence in each period from now on; at the shortest possible one if the period is
    /// too short. Returns the number of this run, which its samples carry.
    fn run(&mut self, sequence: &Sequence, period_us: u32) -> u32;
}
