//! How the controller's own sensors are connected and what their signals mean: what is nominal. What is mounted is the calibration's.
//!
//! Two probes look at the journal from directions a quarter turn apart, a transmitter of 4 to 20 mA measures the load's pressure; all are on one
//! converter of eight inputs. The radius of the journal that the probes look at is the bench's.

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
    /// From one end to the other, uV.
    #[must_use]
    pub const fn span_uv(self) -> u32 {
        match self {
            Self::Bipolar10V => 20_480_000,
            Self::Bipolar5V | Self::Unipolar10V => 10_240_000,
            Self::Bipolar2V5 | Self::Unipolar5V => 5_120_000,
        }
    }

    /// Code at 0 V.
    #[must_use]
    pub const fn zero_code(self) -> u16 {
        match self {
            Self::Bipolar10V | Self::Bipolar5V | Self::Bipolar2V5 => 0x8000,
            Self::Unipolar10V | Self::Unipolar5V => 0,
        }
    }
}

/// The wiring.
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
    /// Gap of a probe with the journal in the bearing's centre, um. Where it really is, is the calibration's offset.
    pub centre_gap_um: [u16; 2],
    /// Direction from the centre to the first probe, hundredths of a degree from +y towards +z; the second is a quarter turn on.
    pub first_probe_centidegrees: i16,
    /// Resistor that the transmitter's current runs over, tenths of an ohm.
    pub shunt_deciohm: u16,
    /// Pressure at 20 mA, kPa.
    pub transmitter_range_kpa: u32,
    /// Area that the pressure pushes along +y, mm2.
    pub piston_mm2: u32,
    /// Whether the controller samples by itself after a restart with this configuration kept.
    pub sample_at_start: bool,
}

impl Wiring {
    /// Probes of 2 mm over 10 V from +y and +z on inputs 0 and 1, 1 mm from the journal in the centre; a transmitter of 250 bar over 250 ohm on
    /// input 2, and a piston of 20 cm2: 50 kN.
    pub const NOMINAL: Self = Self {
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

/// A field of a [`Wiring`], or what several must make together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum WiringField {
    /// An input of the converter: `probe_inputs` or `load_input`.
    Input,
    /// How many different inputs `probe_inputs` and `load_input` are.
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
