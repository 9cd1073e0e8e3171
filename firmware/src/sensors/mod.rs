//! Drivers of the bench's sensors, generic over `embedded-hal` 1.0, and the [`Sampler`] that makes frames of them.
//!
//! | sensor | driver | what it checks |
//! |---|---|---|
//! | two eddy-current probes at 90 degrees, a third one opposite if there is one | [`Ads8688`], [`Scale`], [`ProbePair`] | answer of the bus, rails, both codes of a probe at its ends, the third against the first |
//! | absolute encoder | [`As5047p`] | parity, error flag, answer of the bus |
//! | incremental encoder with index | [`Incremental`] | counts between two passes of the index |
//! | load pressure, 4 to 20 mA | [`Transmitter`] | broken wire, short circuit |
//!
//! A reading is a value or a named [`SensorFault`]; no fault is replaced by a number without saying so. In a sample every device is asked
//! a fixed number of times, without retries: an SPI controller drives the clock itself, so a transaction takes as long as its bits.
//! A device that does not answer is found by what its data line then reads.
//!
//! Whole numbers throughout: nm, nrad, mN; a hundredth of a sensor's resolution is kept.

mod absolute;
mod angle;
mod converter;
mod incremental;
mod probes;
mod sampler;
mod scale;
mod transmitter;

pub use absolute::As5047p;
pub use angle::{Absolute, AngleSensor};
pub use converter::Ads8688;
pub(crate) use converter::INPUTS;
pub use incremental::{Incremental, QuadratureCounter};
pub use link::InputRange;
pub use probes::{Opposite, ProbePair};
pub use sampler::{FaultCounts, LoadInput, Probe, Sampler, Wiring};
pub use scale::{Scale, TABLE_POINTS};
pub use transmitter::Transmitter;

/// Why a channel has no value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SensorFault {
    /// The bus reported an error.
    Bus,
    /// The data line did not read as the device drives it: not connected, without supply, or the bits are shifted.
    NoAnswer,
    /// A written register did not read back.
    NotConfigured,
    /// The parity of an answer is wrong.
    Parity,
    /// The device flags an error in what it was sent.
    ErrorFlag,
    /// The code is at the end of the converter's range.
    AtRail,
    /// Redundant sensors do not agree.
    Disagreement,
    /// The counts between two passes of the index are not whole revolutions: counts were lost or added.
    CountsLost,
    /// Less than 3.6 mA: the wire is broken or the transmitter has failed low.
    BrokenWire,
    /// More than 21 mA: short circuit, or the transmitter has failed high.
    ShortCircuit,
}

/// Every fault, in the order of [`FaultCounts`].
pub const FAULTS: [SensorFault; 10] = [
    SensorFault::Bus,
    SensorFault::NoAnswer,
    SensorFault::NotConfigured,
    SensorFault::Parity,
    SensorFault::ErrorFlag,
    SensorFault::AtRail,
    SensorFault::Disagreement,
    SensorFault::CountsLost,
    SensorFault::BrokenWire,
    SensorFault::ShortCircuit,
];

impl SensorFault {
    /// Lower-case name for logs.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bus => "bus",
            Self::NoAnswer => "no-answer",
            Self::NotConfigured => "not-configured",
            Self::Parity => "parity",
            Self::ErrorFlag => "error-flag",
            Self::AtRail => "at-rail",
            Self::Disagreement => "disagreement",
            Self::CountsLost => "counts-lost",
            Self::BrokenWire => "broken-wire",
            Self::ShortCircuit => "short-circuit",
        }
    }
}
