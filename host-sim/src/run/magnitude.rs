//! Magnitudes of a run's samples, and their text.

use bench::description::TransmissionBench;
use bench::plants::transmission::Snapshot;

/// Returns the samples from the end of the load's ramp on.
pub(crate) fn after_start<'a>(bench: &TransmissionBench, samples: &'a [Snapshot]) -> &'a [Snapshot] {
    let start = samples.partition_point(|s| s.time_s < bench.load.ramp_s);
    samples.get(start..).unwrap_or_default()
}

/// Returns the largest magnitude of a reading.
pub fn peak(samples: &[Snapshot], read: impl Fn(&Snapshot) -> f64) -> f64 {
    samples.iter().map(|s| read(s).abs()).fold(0.0, f64::max)
}

/// Formats a number with five significant digits.
pub(super) fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 || (1e-2..1e6).contains(&size) {
        let digits = (4.0 - size.max(1e-9).log10().floor()).clamp(0.0, 6.0) as usize;
        format!("{value:.digits$}")
    } else {
        format!("{value:.3e}")
    }
}
