//! Measured values and residuals over time, for charts.

use crate::data::logs::{Block, Columns, Data};
use crate::data::split::Use;
use bench::Channel;

/// Measured values and residuals of one channel of a log.
#[derive(Clone, Debug)]
pub struct Series {
    /// Name of the log.
    pub source: String,
    /// Channel.
    pub channel: Channel,
    /// Time in s.
    pub time_s: Vec<f64>,
    /// Phase in cycles, if the motion repeats.
    pub phase: Option<Vec<f64>>,
    /// Position of the drive, m or rad.
    pub position: Vec<f64>,
    /// Measured values.
    pub measured: Vec<f64>,
    /// Measured minus simulated values of the calibrated nominal bench.
    pub before: Vec<f64>,
    /// Measured minus simulated values of the extended bench.
    pub after: Vec<f64>,
    /// True if each sample was held out.
    pub held_out: Vec<bool>,
}

/// Series of every channel of every log, without skipped samples.
pub(crate) fn series(data: &Data, before: &Columns, after: &Columns) -> Vec<Series> {
    let used = |uses: &[Use], values: &[f64]| -> Vec<f64> {
        values.iter().zip(uses).filter(|(_, u)| **u != Use::Skip).map(|(v, _)| *v).collect()
    };
    let series_of = |((block, before), after): ((&Block, &Vec<f64>), &Vec<f64>)| {
        let log = &data.logs[block.log];
        Series {
            source: log.source.clone(),
            channel: block.channel,
            time_s: used(&log.uses, log.inputs.time_s()),
            phase: log.phase.as_ref().map(|p| used(&log.uses, p)),
            position: used(&log.uses, &log.position),
            measured: used(&log.uses, &block.measured),
            before: used(&log.uses, before),
            after: used(&log.uses, after),
            held_out: log.uses.iter().filter(|u| **u != Use::Skip).map(|u| *u == Use::HeldOut).collect(),
        }
    };
    data.blocks.iter().zip(before).zip(after).map(series_of).collect()
}
