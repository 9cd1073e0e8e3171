//! Outputs of a log compared with the described bench under the log's inputs.
//!
//! The mismatch of readings `m` with simulated values `s` is the median of `|m/h - s|` over that of
//! `|s|`, with a factor `h` that the readings may contain. With a changed bench it stays well below
//! 1/2; with a wrong unit or sign it exceeds 1/2.

use super::tuning;
use crate::data::tuning::{END_MARGIN_S, START_MARGIN_S};
use crate::statistics::{median, robust_slope};
use bench::simulate::{Inputs, Response, respond};
use bench::statistics::mean;
use bench::{Bench, Channel, MeasuredLog};

/// Channels of both axes of a quantity.
pub(super) const AXES: [(Channel, Channel); 2] =
    [(Channel::JournalY, Channel::JournalZ), (Channel::BearingForceY, Channel::BearingForceZ)];

/// The described bench under a log's inputs.
pub(super) struct Simulated {
    response: Response,
    steady: std::ops::Range<usize>,
}

impl Simulated {
    /// `None` if the inputs cannot be simulated; the diagnosis then reports why.
    pub(super) fn new(bench: &Bench, log: &MeasuredLog) -> Option<Self> {
        let mut requested = log.clone();
        for (y, z) in AXES {
            // Both axes, to find one under the name of the other.
            if log.channels.contains_key(&y) || log.channels.contains_key(&z) {
                for channel in [y, z] {
                    requested.channels.entry(channel).or_insert_with(|| vec![0.0; log.time_s.len()]);
                }
            }
        }
        let response = respond(bench, &Inputs::new(bench, &requested).ok()?).ok()?;
        let (start, end) = (log.time_s.first()?, log.time_s.last()?);
        let (from, to) = bench.steady_span_s((*start, *end), (START_MARGIN_S, END_MARGIN_S));
        let steady = log.time_s.partition_point(|t| *t < from)..log.time_s.partition_point(|t| *t <= to);
        (steady.len() >= tuning::MIN_STEADY_SAMPLES).then_some(Self { response, steady })
    }

    /// Rows after the start transient and before the end.
    pub(super) fn steady(&self) -> std::ops::Range<usize> {
        self.steady.clone()
    }

    /// Simulated values of a channel over the complete log.
    pub(super) fn channel(&self, channel: Channel) -> Option<&[f64]> {
        self.response.get(&channel).map(Vec::as_slice)
    }

    /// Measured and simulated values of two channels over the steady rows; `None` if the simulated
    /// one is mostly 0.
    fn pair<'a>(
        &'a self,
        log: &'a MeasuredLog,
        measured: Channel,
        simulated: Channel,
    ) -> Option<(&'a [f64], &'a [f64])> {
        let (m, s) = (log.channels.get(&measured)?, self.channel(simulated)?);
        let s = s.get(self.steady())?;
        (size(s) > 0.0).then_some((m.get(self.steady())?, s))
    }

    /// Mismatch of a measured channel, under a factor, with a simulated channel.
    pub(super) fn mismatch(
        &self,
        log: &MeasuredLog,
        measured: Channel,
        simulated: Channel,
        factor: f64,
    ) -> Option<f64> {
        let (m, s) = self.pair(log, measured, simulated)?;
        Some(median(m.iter().zip(s).map(|(m, s)| (m / factor - s).abs())) / size(s))
    }

    /// Robust gain of a channel relative to its simulation.
    pub(super) fn gain(&self, log: &MeasuredLog, channel: Channel) -> Option<f64> {
        let (m, s) = self.pair(log, channel, channel)?;
        robust_slope(s, m)
    }

    /// Mean mismatch of all outputs, number of outputs with a large mismatch, and number of
    /// outputs.
    pub(super) fn overall(&self, bench: &Bench, log: &MeasuredLog) -> (f64, usize, usize) {
        let outputs = bench.outputs(log).into_iter();
        let all: Vec<f64> = outputs.filter_map(|c| self.mismatch(log, c, c, 1.0)).collect();
        let wrong = all.iter().filter(|r| **r > tuning::LOAD_MISMATCH).count();
        (mean(all.iter().map(|r| r.min(tuning::MAX_MISMATCH_COUNTED))), wrong, all.len())
    }
}

/// Median magnitude.
fn size(values: &[f64]) -> f64 {
    median(values.iter().map(|v| v.abs()))
}
