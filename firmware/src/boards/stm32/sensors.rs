//! Devices on the sensor bus: an ADS8688 with two probes and a load transmitter, and an AS5047P.
//!
//! The wiring of the configuration assigns the inputs and scales their codes.

use super::spi::Device;
use controller::configuration::{BENCH_B, wiring};
use controller::sensors::{Absolute, Ads8688, As5047p, Sampler};
use core::convert::Infallible;
use embedded_hal::digital::OutputPin;

/// Sampler of the converter with select `A` and the encoder with select `B`.
pub(in crate::boards) type Sensors<A, B> = Sampler<Device<A>, Absolute<Device<B>>>;

/// Creates the sampler of both devices with the nominal wiring, which a configuration replaces.
pub(in crate::boards) fn sampler<A, B>(converter: Device<A>, encoder: Device<B>) -> Option<Sensors<A, B>>
where
    A: OutputPin<Error = Infallible>,
    B: OutputPin<Error = Infallible>,
{
    let nominal = wiring(&BENCH_B)?;
    Some(Sampler::new(Ads8688::new(converter), Absolute::new(As5047p::new(encoder)), nominal))
}
