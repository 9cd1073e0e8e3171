//! Counters of events, so that no loss goes unnoticed.

use serde::{Deserialize, Serialize};

/// Counts since the last configuration; those of the link since the start. All counters saturate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    /// Samples served.
    pub samples: u32,
    /// Samples whose estimate carried a sensor flag.
    pub flagged: u32,
    /// Samples with a sequence number out of order.
    pub sequence_gaps: u32,
    /// Samples whose time did not advance by the sample period.
    pub time_faults: u32,
    /// Estimates above the force limit.
    pub over_force: u32,
    /// Estimates that took longer than the sample period.
    pub deadline_overruns: u32,
    /// Number of trips.
    pub trips: u32,
    /// Estimates held because the controller had tripped.
    pub held: u32,
    /// Timer ticks without a waiting sample (silicon).
    pub idle_ticks: u32,
    /// Samples of the link that were dropped: full queue, or a controller that takes its own.
    pub dropped_samples: u32,
    /// Estimates dropped because the queue was full or the line accepted none.
    pub dropped_estimates: u32,
    /// Impacts that were recorded.
    pub impacts: u32,
    /// Records of impacts dropped because the queue was full, the line accepted none, or memory was
    /// corrupted.
    pub dropped_impacts: u32,
    /// Other answers that were dropped.
    pub dropped_answers: u32,
    /// Commands that were repeated and answered again.
    pub repeated_commands: u32,
    /// Commands that were refused.
    pub refused_commands: u32,
    /// Received bytes dropped because the buffer was full.
    pub dropped_bytes: u32,
    /// Receive errors of the serial port.
    pub line_errors: LineErrors,
    /// Frames that were refused.
    pub bad_frames: crate::BadFrames,
}

/// Receive errors that the serial port's hardware detected, each at most once per byte.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LineErrors {
    /// A byte arrived before the previous one was fetched: one of them is lost.
    pub overruns: u32,
    /// No stop bit: another baud rate, or a broken or unconnected line.
    pub framing: u32,
    /// The samples of a bit did not agree: noise.
    pub noise: u32,
}
