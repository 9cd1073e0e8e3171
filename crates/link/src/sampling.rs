//! Timing of the controller's own samples.

use serde::{Deserialize, Serialize};

/// Counts and measurements of the controller's own samples since the start. The counters saturate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SamplingReport {
    /// Samples that no tick took, because the core was halted or busy.
    pub lost: u32,
    /// Halts of the core, as by a debugger.
    pub halts: u32,
    /// Duration of all halts, us.
    pub halted_us: u32,
    /// Longest time by which a sample was complete earlier than a period after the one before, ns;
    /// since the period was set. With [`Self::late_ns`] an upper bound on the jitter.
    pub early_ns: u32,
    /// Longest time by which a sample was complete later, ns.
    pub late_ns: u32,
    /// Time from the sample of the first probe to that of the second, ns. The estimates take it
    /// into account.
    pub input_interval_ns: u32,
}
