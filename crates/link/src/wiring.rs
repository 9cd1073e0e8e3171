//! Nominal wiring and signal ranges of the controller's own sensors. Deviations of the mounted
//! sensors belong to the calibration.
//!
//! Two probes measure the journal's position from directions a quarter turn apart. A transmitter of
//! 4 to 20 mA measures the pressure of the load. All are connected to one converter with eight
//! inputs. The journal radius is that of the bench.

use serde::{Deserialize, Serialize};

/// Input range of the converter: bits of the ADS8688's range-select register.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum InputRange {
    /// -10.24 to 10.24 V.
    Bipolar10V = 0b000,
    /// -5.12 to 5.12 V.
    Bipolar5V = 0b001,
    /// -2.56 to 2.56 V.
    Bipolar2V5 = 0b010,
    /// 0 to 10.24 V.
    Unipolar10V = 0b101,
    /// 0 to 5.12 V.
    Unipolar5V = 0b110,
}

impl InputRange {
    /// Returns the width of the range, uV.
    #[must_use]
    pub const fn span_uv(self) -> u32 {
        match self {
            Self::Bipolar10V => 20_480_000,
            Self::Bipolar5V | Self::Unipolar10V => 10_240_000,
            Self::Bipolar2V5 | Self::Unipolar5V => 5_120_000,
        }
    }

    /// Returns the code at 0 V.
    #[must_use]
    pub const fn zero_code(self) -> u16 {
        match self {
            Self::Bipolar10V | Self::Bipolar5V | Self::Bipolar2V5 => 0x8000,
            Self::Unipolar10V | Self::Unipolar5V => 0,
        }
    }
}

/// Wiring of the sensors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Wiring {
    /// Inputs of the two probes, from 0.
    pub probe_inputs: [u8; 2],
    /// Input of the load transmitter.
    pub load_input: u8,
    /// Range of the probes' inputs.
    pub probe_range: InputRange,
    /// Range of the transmitter's input.
    pub load_range: InputRange,
    /// Gap of a probe over its voltage, nm/V; negative if it falls with the gap.
    pub probe_gain_nm_v: [i32; 2],
    /// Gap of a probe with the journal in the bearing's centre, um. Deviations of the mounted probe
    /// belong to the calibration's offset.
    pub centre_gap_um: [u16; 2],
    /// Direction from the centre to the first probe, hundredths of a degree from +y towards +z. The
    /// second probe is a quarter turn further.
    pub first_probe_centidegrees: i16,
    /// Resistor that carries the transmitter's current, tenths of an ohm.
    pub shunt_deciohm: u16,
    /// Pressure at 20 mA, kPa.
    pub transmitter_range_kpa: u32,
    /// Area on which the pressure acts along +y, mm2.
    pub piston_mm2: u32,
    /// `true` if the controller samples on its own after a restart with this stored configuration.
    pub sample_at_start: bool,
}

impl Wiring {
    /// Probes of 2 mm over 10 V from +y and +z on inputs 0 and 1, 1 mm from the centred journal; a
    /// transmitter of 250 bar over 250 ohm on input 2 and a piston of 20 cm2: 50 kN.
    pub(crate) const NOMINAL: Self = Self {
        probe_inputs: [0, 1],
        load_input: 2,
        probe_range: InputRange::Unipolar10V,
        load_range: InputRange::Unipolar5V,
        probe_gain_nm_v: [200_000; 2],
        centre_gap_um: [1_000; 2],
        first_probe_centidegrees: 0,
        shunt_deciohm: 2_500,
        transmitter_range_kpa: 25_000,
        piston_mm2: 2_000,
        sample_at_start: false,
    };
}

/// Field of a [`Wiring`], or a property of several fields together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum WiringField {
    /// An input of the converter: `probe_inputs` or `load_input`.
    Input,
    /// Number of different inputs among `probe_inputs` and `load_input`.
    DistinctInputs,
    /// `probe_gain_nm_v`, without its sign.
    ProbeGain,
    /// `centre_gap_um`.
    CentreGap,
    /// `first_probe_centidegrees`.
    FirstProbe,
    /// `shunt_deciohm`.
    Shunt,
    /// `transmitter_range_kpa`.
    TransmitterRange,
    /// The force at 20 mA, N: `transmitter_range_kpa` times `piston_mm2`.
    LoadSpan,
}
