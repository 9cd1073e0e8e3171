//! What happened, in numbers: nothing is lost without being counted.

use serde::{Deserialize, Serialize};

/// What the controller counted since it was configured (link: since it started). The counts stop at their maximum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    /// Samples served.
    pub samples: u32,
    /// Samples whose estimate carried a sensor flag.
    pub flagged: u32,
    /// Samples whose sequence number did not follow.
    pub sequence_gaps: u32,
    /// Samples whose time did not advance by the sample period.
    pub time_faults: u32,
    /// Estimates above the force limit.
    pub over_force: u32,
    /// Estimates that took longer than the sample period.
    pub deadline_overruns: u32,
    /// Times that the controller tripped.
    pub trips: u32,
    /// Estimates held because the controller had tripped.
    pub held: u32,
    /// Timer ticks that found no sample waiting (silicon).
    pub idle_ticks: u32,
    /// Samples of the link dropped: the queue was full, or the controller takes its own.
    pub dropped_samples: u32,
    /// Estimates dropped because the queue was full or the line took none.
    pub dropped_estimates: u32,
    /// Other answers that were dropped.
    pub dropped_answers: u32,
    /// Commands that came again and were answered again.
    pub repeated_commands: u32,
    /// Commands that were refused.
    pub refused_commands: u32,
    /// Received bytes dropped because the buffer was full.
    pub dropped_bytes: u32,
    /// Bytes that the serial port itself received wrongly.
    pub line_errors: LineErrors,
    /// Frames that were refused.
    pub bad_frames: crate::BadFrames,
}

/// What the serial port's hardware found wrong with what it received, each found at most once a byte.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LineErrors {
    /// A byte came before the one before it was fetched: one of them is lost.
    pub overruns: u32,
    /// No stop bit where it had to be: another baud rate, a broken or unconnected line.
    pub framing: u32,
    /// The samples of a bit did not agree: disturbances.
    pub noise: u32,
}
