//! Devices on the sensor bus: an ADS8688 with two probes and a load transmitter, and an AS5047P.
//!
//! The wiring of the configuration assigns the inputs and scales their codes.

use super::Acquisition;
use controller::configuration::{BENCH_B, wiring};
use controller::sensors::{Absolute, Sampler};
use controller::session::IDLE_PERIOD_US;

/// Sampler of both devices.
pub type Sensors = Sampler<Acquisition, Absolute>;

/// Creates the sampler with the nominal wiring, which a configuration replaces.
pub(in crate::boards) fn sampler(acquisition: Acquisition) -> Option<Sensors> {
    Some(Sampler::new(acquisition, Absolute::default(), wiring(&BENCH_B)?, IDLE_PERIOD_US))
}
