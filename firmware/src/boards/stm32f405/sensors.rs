//! What is connected to the sensors' bus: an ADS8688 with two probes and a load transmitter, an AS5047P.
//!
//! | input of the converter | sensor | scale |
//! |---|---|---|
//! | 0 | probe from +y | 0 to 10 V for a gap of 0 to 2 mm; gap of 1 mm with the journal in the centre |
//! | 1 | probe from +z | the same |
//! | 2 | load transmitter, 4 to 20 mA over 250 ohm | 250 bar on 20 cm2: 50 kN |
//!
//! These are nominal: what the bench's probes really are, mounted as they are, is the calibration of the configuration.

use stm32f4xx_hal::gpio::{Output, PB8, PB9, PushPull};

use super::spi::Device;
use crate::sensors::{
    Absolute, Ads8688, As5047p, InputRange, LoadInput, Probe, ProbePair, Sampler, Scale, Transmitter, Wiring,
};

/// The sensors of this board.
pub type Sensors = Sampler<Device<PB9<Output<PushPull>>>, Absolute<Device<PB8<Output<PushPull>>>>>;

/// Gap with the journal in the centre, nm.
const CENTRE_GAP_NM: i32 = 1_000_000;
/// 10.24 V are 65,536 codes, 10 V are 2 mm: 31.25 nm a code.
const PROBE_GAIN_Q16: i32 = 2_048_000;
/// 5.12 V are 65,536 codes; over 250 ohm 312.5 nA a code.
const CURRENT_GAIN_Q16: i32 = 20_480_000;
const LOAD_RANGE_PA: u32 = 25_000_000;
const PISTON_MM2: u32 = 2_000;
/// Radius of the journal that the probes look at, nm.
const JOURNAL_RADIUS_NM: u32 = 69_500_000;

const fn probe(input: u8) -> Probe {
    Probe { input, scale: Scale { zero_code: 0, gain_nm_q16: PROBE_GAIN_Q16, table_nm: None } }
}

/// The sampler of the two devices; none if the constants above contradict each other.
pub(super) fn sampler(
    converter: Device<PB9<Output<PushPull>>>,
    encoder: Device<PB8<Output<PushPull>>>,
) -> Option<Sensors> {
    let wiring = Wiring {
        probes: [probe(0), probe(1)],
        opposite: None,
        geometry: ProbePair::new([1 << 30, 0], [CENTRE_GAP_NM; 2], JOURNAL_RADIUS_NM, None)?,
        load: LoadInput {
            input: 2,
            transmitter: Transmitter::new(0, CURRENT_GAIN_Q16, LOAD_RANGE_PA, PISTON_MM2)?,
        },
        counter_load: None,
        probe_range: InputRange::Unipolar10V,
        load_range: InputRange::Unipolar5V,
    };
    Some(Sampler::new(Ads8688::new(converter), Absolute::new(As5047p::new(encoder)), wiring))
}
