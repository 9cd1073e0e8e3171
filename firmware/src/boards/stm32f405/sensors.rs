//! What is connected to the sensors' bus: an ADS8688 with two probes and a load transmitter, an AS5047P.
//!
//! Which input is what and what its codes mean is the configuration's wiring.

use stm32f4xx_hal::gpio::{Output, PB8, PB9, PushPull};

use super::spi::Device;
use crate::configuration::{BENCH_B, wiring};
use crate::sensors::{Absolute, Ads8688, As5047p, Sampler};

/// The sensors of this board.
pub type Sensors = Sampler<Device<PB9<Output<PushPull>>>, Absolute<Device<PB8<Output<PushPull>>>>>;

/// The sampler of the two devices, wired as nominal until a configuration tells.
pub(super) fn sampler(
    converter: Device<PB9<Output<PushPull>>>,
    encoder: Device<PB8<Output<PushPull>>>,
) -> Option<Sensors> {
    let nominal = wiring(&BENCH_B)?;
    Some(Sampler::new(Ads8688::new(converter), Absolute::new(As5047p::new(encoder)), nominal))
}
