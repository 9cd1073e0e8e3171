//! Logs prepared for comparison with a simulation: inputs smoothed, cycles found, samples split.

use super::cycles::phases;
use super::split::{Split, Timeline, Use, cycle_count};
use super::tuning;
use bench::log::LogError;
use bench::simulate::{Inputs, Response};
use bench::{Bench, Channel, MeasuredLog};

/// One log; vectors have one entry per sample.
pub(crate) struct Log {
    /// Position among all logs, held-out logs after fitted ones. The same in every view.
    pub(crate) index: usize,
    pub(crate) source: String,
    /// Smoothed motion and load, which drive the simulation.
    pub(crate) inputs: Inputs,
    pub(crate) uses: Vec<Use>,
    /// Cycles since the first upward crossing of the middle of the motion; the integer part counts
    /// cycles.
    pub(crate) phase: Option<Vec<f64>>,
    /// Position of the drive, m or rad.
    pub(crate) position: Vec<f64>,
    /// Speed of the drive, m/s or rad/s.
    pub(crate) speed: Vec<f64>,
    /// Load, N.
    pub(crate) load: Vec<f64>,
}

/// One output channel of one log.
pub(crate) struct Block {
    /// Position of the log in [`Data::logs`].
    pub(crate) log: usize,
    pub(crate) channel: Channel,
    pub(crate) measured: Vec<f64>,
}

/// All logs.
pub(crate) struct Data {
    pub(crate) logs: Vec<Log>,
    pub(crate) blocks: Vec<Block>,
    /// Channels of the blocks, each once, in order.
    pub(crate) channels: Vec<Channel>,
}

/// One value per sample for every block of [`Data`].
pub(crate) type Columns = Vec<Vec<f64>>;

impl Data {
    /// Prepares logs for a diagnosis. Without `held_out` logs, `split` holds out a part of each
    /// log.
    pub(crate) fn new(
        bench: &Bench,
        fitted: &[MeasuredLog],
        held_out: &[MeasuredLog],
        split: Split,
    ) -> Result<Self, LogError> {
        Self::with_outputs(bench, (fitted, held_out), split, diagnosed_outputs)
    }

    /// Prepares logs for a comparison of the outputs that `outputs_of` returns.
    pub(crate) fn with_outputs(
        bench: &Bench,
        (fitted, held_out): (&[MeasuredLog], &[MeasuredLog]),
        split: Split,
        outputs_of: impl Fn(&Bench, &MeasuredLog) -> Vec<Channel>,
    ) -> Result<Self, LogError> {
        let (mut logs, mut blocks) = (Vec::new(), Vec::new());
        let split = held_out.is_empty().then_some(split);
        let all = fitted.iter().map(|l| (l, true)).chain(held_out.iter().map(|l| (l, false)));
        for (index, (measured, is_fitted)) in all.enumerate() {
            let inputs = Inputs::new(bench, measured)?;
            let log = Log::new(bench, index, measured, inputs, is_fitted, split);
            let simulated = outputs_of(bench, measured);
            let outputs = simulated.into_iter().filter_map(|c| Some((c, measured.channels.get(&c)?)));
            let own: Vec<Block> = outputs
                .map(|(channel, values)| Block { log: index, channel, measured: values.clone() })
                .collect();
            if own.is_empty() {
                return Err(LogError::Content {
                    file: measured.source.clone(),
                    found: "no output channel that this plant simulates".into(),
                    expected: "at least one measured output of the plant, such as a force or a position"
                        .into(),
                });
            }
            let used = log.uses.iter().filter(|u| **u != Use::Skip).count();
            if used < tuning::MIN_USED_SAMPLES {
                return Err(LogError::Content {
                    file: measured.source.clone(),
                    found: format!("{used} samples after the start transient"),
                    expected: format!("at least {}", tuning::MIN_USED_SAMPLES),
                });
            }
            blocks.extend(own);
            logs.push(log);
        }
        let mut channels: Vec<Channel> = blocks.iter().map(|b| b.channel).collect();
        channels.sort();
        channels.dedup();
        Ok(Self { logs, blocks, channels })
    }

    /// Turns held-out samples into fitted ones.
    pub(crate) fn use_all(&mut self) {
        let uses = self.logs.iter_mut().flat_map(|log| &mut log.uses);
        uses.filter(|used| **used == Use::HeldOut).for_each(|used| *used = Use::Fit);
    }

    /// The logs up to their last fitted sample: all that a fit has to simulate.
    pub(crate) fn fitted_view(&self) -> Self {
        self.view(|log| log.uses.iter().rposition(|u| *u == Use::Fit).map_or(0, |last| last + 1))
    }

    /// The first cycle of each log, for inexpensive simulations; `None` if that is no shorter.
    pub(crate) fn first_cycle_view(&self) -> Option<Self> {
        let view = self.view(|log| match &log.phase {
            Some(phase) => {
                let start = phase.first().copied().unwrap_or_default();
                phase.partition_point(|p| *p < start + 1.0)
            }
            None => log.uses.len(),
        });
        let samples = |d: &Self| d.logs.iter().map(|log| log.uses.len()).sum::<usize>();
        (samples(&view) < samples(self)).then_some(view)
    }

    /// The calibration samples of held-out logs, as samples to be fitted; `None` if there are none.
    pub(crate) fn calibration_view(&self) -> Option<Self> {
        let end = |log: &Log| log.uses.iter().rposition(|u| *u == Use::Calibrate).map_or(0, |last| last + 1);
        let mut view = self.view(end);
        for used in view.logs.iter_mut().flat_map(|log| &mut log.uses) {
            *used = if *used == Use::Calibrate { Use::Fit } else { Use::Skip };
        }
        (!view.logs.is_empty()).then_some(view)
    }

    /// Shortens every log to a count of samples and leaves out logs with a count of 0.
    fn view(&self, count: impl Fn(&Log) -> usize) -> Self {
        let mut shortened = Vec::new();
        let mut logs = Vec::new();
        for log in &self.logs {
            let count = count(log);
            shortened.push((count > 0).then_some((logs.len(), count)));
            if count > 0 {
                logs.push(log.truncated(count));
            }
        }
        let truncated = |b: &Block| {
            let (log, count) = shortened.get(b.log).copied().flatten()?;
            let measured = b.measured.get(..count)?.to_vec();
            Some(Block { log, channel: b.channel, measured })
        };
        let blocks = self.blocks.iter().filter_map(truncated).collect();
        Self { logs, blocks, channels: self.channels.clone() }
    }

    /// The columns of simulated outputs, given one response per log.
    pub(crate) fn columns(&self, responses: &[Response]) -> Columns {
        self.blocks
            .iter()
            .map(|b| {
                let values = responses.get(b.log).and_then(|r| r.get(&b.channel));
                values.cloned().unwrap_or_else(|| vec![0.0; b.measured.len()])
            })
            .collect()
    }

    /// Measured minus simulated values.
    pub(crate) fn residual(&self, simulated: &Columns) -> Columns {
        self.blocks
            .iter()
            .zip(simulated)
            .map(|(b, s)| b.measured.iter().zip(s).map(|(m, s)| m - s).collect())
            .collect()
    }

    /// Uses of the samples of a block.
    pub(crate) fn uses(&self, block: &Block) -> &[Use] {
        &self.logs[block.log].uses
    }

    /// A value for each fitted sample with the index of its block, in the order of
    /// [`super::noise::NoiseModel::stack`].
    pub(crate) fn map_fitted(&self, read: impl Fn(&Log, usize) -> f64) -> Vec<(usize, f64)> {
        let mut out = Vec::new();
        for (index, block) in self.blocks.iter().enumerate() {
            let log = &self.logs[block.log];
            let fitted = (0..block.measured.len()).filter(|&i| log.uses.get(i) == Some(&Use::Fit));
            out.extend(fitted.map(|i| (index, read(log, i))));
        }
        out
    }

    /// Number of samples of a channel with a use.
    pub(crate) fn count(&self, channel: Channel, with_use: Use) -> usize {
        let count_in = |b: &Block| self.uses(b).iter().filter(|u| **u == with_use).count();
        self.blocks.iter().filter(|b| b.channel == channel).map(count_in).sum()
    }
}

/// Outputs that the plant simulates under the log's inputs.
pub(crate) fn simulated_outputs(bench: &Bench, log: &MeasuredLog) -> Vec<Channel> {
    bench.outputs(log).into_iter().filter(|channel| bench.simulates(*channel)).collect()
}

/// Outputs that a diagnosis compares. In open loop a position adds up the errors of the input over
/// the complete log, so it is left out where a speed is measured.
fn diagnosed_outputs(bench: &Bench, log: &MeasuredLog) -> Vec<Channel> {
    let mut outputs = simulated_outputs(bench, log);
    if let Some(drive) = bench.drive_channels().filter(|_| bench.is_open_loop())
        && outputs.contains(&drive.speed)
    {
        outputs.retain(|channel| *channel != drive.position);
    }
    outputs
}

impl Log {
    fn new(
        bench: &Bench,
        index: usize,
        measured: &MeasuredLog,
        inputs: Inputs,
        is_fitted: bool,
        split: Option<Split>,
    ) -> Self {
        let times = &measured.time_s;
        let motions: Vec<_> = times.iter().map(|&t| inputs.drive(t)).collect();
        let position: Vec<f64> = motions.iter().map(|m| m.value).collect();
        let phase = phases(times, &position);
        let start = times.first().copied().unwrap_or_default();
        let end = times.last().copied().unwrap_or_default();
        let used_s = bench.steady_span_s((start, end), (tuning::START_MARGIN_S, tuning::END_MARGIN_S));
        let timeline = Timeline { time_s: times, phase: phase.as_deref(), used_s };
        let uses = if is_fitted {
            timeline.fitted_uses(split)
        } else {
            timeline.held_out_uses(!bench.nuisances().is_empty())
        };
        Self {
            index,
            source: measured.source.clone(),
            uses,
            phase,
            speed: motions.iter().map(|m| m.rate).collect(),
            load: times.iter().map(|&t| inputs.load_n(t)).collect(),
            position,
            inputs,
        }
    }

    /// Indices of the fitted samples.
    pub(crate) fn fitted_samples(&self) -> impl Iterator<Item = usize> {
        self.uses.iter().enumerate().filter(|(_, used)| **used == Use::Fit).map(|(i, _)| i)
    }

    /// Returns whether it has two complete cycles, of which one can be held out.
    pub(crate) fn has_two_cycles(&self) -> bool {
        cycle_count(self.phase.as_deref()) + tuning::MISSING_CYCLE_SHARE >= 2.0
    }

    fn truncated(&self, count: usize) -> Self {
        let cut = |values: &[f64]| values.get(..count).unwrap_or(values).to_vec();
        Self {
            index: self.index,
            source: self.source.clone(),
            inputs: self.inputs.first(count),
            uses: self.uses.get(..count).unwrap_or(&self.uses).to_vec(),
            phase: self.phase.as_deref().map(cut),
            position: cut(&self.position),
            speed: cut(&self.speed),
            load: cut(&self.load),
        }
    }
}
