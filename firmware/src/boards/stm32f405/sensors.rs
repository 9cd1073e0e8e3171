//! Devices on the sensor bus: an ADS8688 with two probes and a load transmitter, and an AS5047P.
//!
//! The wiring of the configuration assigns the inputs and scales their codes.

use stm32f4xx_hal::gpio::{Output, PB8, PB9, PushPull};

use super::spi::Device;
use controller::configuration::{BENCH_B, wiring};
use controller::sensors::{Absolute, Ads8688, As5047p, Sampler};

/// The sensors of this board.
pub type Sensors = Sampler<Device<PB9<Output<PushPull>>>, Absolute<Device<PB8<Output<PushPull>>>>>;

/// Creates the sampler of both devices with the nominal wiring, which a configuration replaces.
pub(super) fn sampler(
    converter: Device<PB9<Output<PushPull>>>,
    encoder: Device<PB8<Output<PushPull>>>,
) -> Option<Sensors> {
    let nominal = wiring(&BENCH_B)?;
    Some(Sampler::new(Ads8688::new(converter), Absolute::new(As5047p::new(encoder)), nominal))
}
