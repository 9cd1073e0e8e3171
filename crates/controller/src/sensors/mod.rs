//! Drivers of the bench's sensors, generic over `embedded-hal` 1.0, and the [`Sampler`] that makes
//! frames of them.
//!
//! * Two eddy-current probes at 90 degrees, optionally a third one opposite ([`Ads8688`],
//!   [`Scale`], [`ProbePair`]). Checked: answer of the bus, rails, codes at the ends, the third
//!   probe against the first.
//! * Absolute encoder ([`Absolute`]). Checked: parity, error flag, answer of the bus.
//! * Incremental encoder with index ([`Incremental`]). Checked: counts between two passes of the
//!   index.
//! * Load pressure, 4 to 20 mA ([`Transmitter`]). Checked: broken wire, short circuit.
//!
//! A reading is a value or a named [`SensorFault`]. No fault is replaced by a number silently. A
//! sample is a [`Sequence`] of words without retries, which hardware exchanges at each tick of the
//! sample timer. A device that does not answer is recognised by what its data line reads.
//! [`SampleClock`] counts the samples that were lost and measures when they were complete.
//!
//! All values are integers: nm, nrad, mN. They resolve a hundredth of a sensor's resolution.

mod absolute;
mod angle;
mod bus;
mod converter;
mod incremental;
mod probes;
mod sample_clock;
mod sampler;
mod scale;
mod sequence;
mod transmitter;

pub use angle::{Absolute, AngleSensor};
pub use bus::SensorBus;
pub use converter::Ads8688;
pub(crate) use converter::INPUTS;
pub use incremental::{Incremental, QuadratureCounter};
pub use link::InputRange;
pub use probes::{Opposite, ProbePair};
pub use sample_clock::{Acquired, Collected, Completion, Passed, SampleClock};
pub use sampler::{FaultCounts, LoadInput, Probe, Sampler, Wiring};
pub use scale::Scale;
pub use sequence::{
    Answers, Device, EncoderAnswers, MAX_SLOTS, MAX_WORDS, Schedule, Sequence, Slot, SlotTiming, Word,
};
pub use transmitter::Transmitter;

/// Reason why a channel has no value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SensorFault {
    /// The bus reported an error.
    Bus,
    /// The data line did not show what the device drives: not connected, no supply, or shifted
    /// bits.
    NoAnswer,
    /// A written register did not read back.
    NotConfigured,
    /// The parity of an answer is wrong.
    Parity,
    /// The device flags an error in a frame that it received.
    ErrorFlag,
    /// The code is at the end of the converter's range.
    AtRail,
    /// Redundant sensors do not agree.
    Disagreement,
    /// The counts between two passes of the index are not complete revolutions: counts were lost or
    /// added.
    CountsLost,
    /// Less than 3.6 mA: the wire is broken, or the transmitter signals a failure by a low current.
    BrokenWire,
    /// More than 21 mA: short circuit, or the transmitter signals a failure by a high current.
    ShortCircuit,
}

/// All faults, in the order of [`FaultCounts`].
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
    /// Returns the lower-case name for logs.
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
