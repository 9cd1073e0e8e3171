//! Logs prepared for comparison: inputs smoothed, cycles found, every sample fitted, held out or left out.
//!
//! Of a log of two and more cycles the first half is fitted and the second held out: what an imitation has learnt of one half it has to show in
//! the other. What comes in the second half only cannot be learnt so; [`Split::Turns`] is for that.

use crate::cycles::phases;
use bench::log::LogError;
use bench::respond::{Inputs, Response};
use bench::{Bench, Channel, MeasuredLog};

/// Left out at the start of a transmission bench's log beyond the load's ramp: the journal's landing.
const START_MARGIN_S: f64 = 0.010;
/// Left out at the end of it: the smoothing of the drive is one-sided there.
const END_MARGIN_S: f64 = 0.010;
/// Blocks that a log without cycles is cut into; every second one is held out.
const BLOCKS: usize = 16;
/// Stretches of a cycle that are fitted and held out by turns, and the fewest samples of one. An onset that falls into
/// one that is held out is known to its length: .1 s of a cycle of 4 s. Odd, so that the turns change from cycle to cycle.
const STRETCHES: f64 = 41.0;
const LEAST_STRETCH: f64 = 16.0;

/// What is held out of a log of two and more cycles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Split {
    /// The second half of the cycles.
    Halves,
    /// Short stretches by turns, which change from one cycle to the next, so that every phase of the motion and every part of the log is fitted and held
    /// out. A stretch is several times longer than a sensor's noise remembers; what is correlated longer than that lies in both.
    Turns,
}

/// What may be missing of a whole cycle, in cycles.
const WHOLE_CYCLE: f64 = 0.05;
/// One over the share of a log without cycles that tells its nuisances, where it is held out.
const SETTLING: usize = 8;

/// What a sample is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Use {
    /// Nothing.
    Skip,
    /// Fitted.
    Fit,
    /// Held out: nothing is fitted on it; it counts in the noise floors and in the choice between causes.
    Held,
    /// In a log that is held out: tells that session's own nuisances and nothing else.
    Settle,
}

/// One log.
pub(crate) struct Session {
    /// Its place among all logs, those held out after those to be fitted: the same in every view.
    pub(crate) number: usize,
    pub(crate) source: String,
    pub(crate) inputs: Inputs,
    pub(crate) uses: Vec<Use>,
    /// Cycles since the first crossing of the middle of the motion; the whole part counts cycles.
    pub(crate) phase: Option<Vec<f64>>,
    pub(crate) position: Vec<f64>,
    pub(crate) speed: Vec<f64>,
    pub(crate) load: Vec<f64>,
}

/// One output channel of one log.
pub(crate) struct Block {
    pub(crate) session: usize,
    pub(crate) channel: Channel,
    pub(crate) measured: Vec<f64>,
}

/// All logs.
pub(crate) struct Data {
    pub(crate) sessions: Vec<Session>,
    pub(crate) blocks: Vec<Block>,
    /// Channels of the blocks, each once, in order.
    pub(crate) channels: Vec<Channel>,
}

/// One value a sample for every block of [`Data`].
pub(crate) type Columns = Vec<Vec<f64>>;

impl Data {
    /// Prepares logs; without `held_out` a part of each log is held out.
    pub(crate) fn new(
        bench: &Bench,
        logs: &[MeasuredLog],
        held_out: &[MeasuredLog],
        split: Split,
    ) -> Result<Self, LogError> {
        let mut sessions = Vec::new();
        let mut blocks = Vec::new();
        for (log, fitted) in logs.iter().map(|l| (l, true)).chain(held_out.iter().map(|l| (l, false))) {
            let inputs = Inputs::new(bench, log)?;
            let first = sessions.len();
            let split = held_out.is_empty().then_some(split);
            let mut session = Session::new(bench, log, inputs, fitted, split);
            session.number = first;
            if !fitted && !bench.nuisances().is_empty() {
                session.settle();
            }
            let simulated = simulable(bench, log);
            for (channel, values) in log.outputs().filter(|(c, _)| simulated.contains(c)) {
                blocks.push(Block { session: first, channel, measured: values.to_vec() });
            }
            if !blocks.iter().any(|b: &Block| b.session == first) {
                return Err(LogError::Content {
                    file: log.source.clone(),
                    found: "no output channel that this plant simulates".into(),
                    expected: "at least one measured output of the plant, such as a force or a position"
                        .into(),
                });
            }
            let used = session.uses.iter().filter(|u| **u != Use::Skip).count();
            if used < 32 {
                return Err(LogError::Content {
                    file: log.source.clone(),
                    found: format!("{used} samples after the start transient"),
                    expected: "at least 32".into(),
                });
            }
            sessions.push(session);
        }
        let mut channels: Vec<Channel> = blocks.iter().map(|b| b.channel).collect();
        channels.sort();
        channels.dedup();
        Ok(Self { sessions, blocks, channels })
    }

    /// The same without what comes after the last fitted sample: all that a fit has to simulate.
    pub(crate) fn fitted(&self) -> Self {
        self.view(|s| s.uses.iter().rposition(|u| *u == Use::Fit).map_or(0, |last| last + 1))
    }

    /// The first fitted cycle, to get near with cheap simulations; `None` where that saves nothing.
    pub(crate) fn coarse(&self) -> Option<Self> {
        let view = self.view(|s| match &s.phase {
            Some(phase) => {
                let start = phase.first().copied().unwrap_or_default();
                phase.partition_point(|p| *p < start + 1.0)
            }
            None => s.uses.len(),
        });
        let samples = |d: &Self| d.sessions.iter().map(|s| s.uses.len()).sum::<usize>();
        (samples(&view) < samples(self)).then_some(view)
    }

    /// The parts of held-out sessions that tell their nuisances, as samples to be fitted; `None` where there are none.
    pub(crate) fn settling(&self) -> Option<Self> {
        let mut view =
            self.view(|s| s.uses.iter().rposition(|u| *u == Use::Settle).map_or(0, |last| last + 1));
        for used in view.sessions.iter_mut().flat_map(|s| &mut s.uses) {
            *used = if *used == Use::Settle { Use::Fit } else { Use::Skip };
        }
        (!view.sessions.is_empty()).then_some(view)
    }

    /// Shortens every session to a count of samples and leaves out those that keep none.
    fn view(&self, count: impl Fn(&Session) -> usize) -> Self {
        let mut place = Vec::new();
        let mut sessions = Vec::new();
        for session in &self.sessions {
            let count = count(session);
            place.push((count > 0).then_some((sessions.len(), count)));
            if count > 0 {
                sessions.push(session.first(count));
            }
        }
        let short = |b: &Block| {
            let (session, count) = place.get(b.session).copied().flatten()?;
            let measured = b.measured.get(..count)?.to_vec();
            Some(Block { session, channel: b.channel, measured })
        };
        let blocks = self.blocks.iter().filter_map(short).collect();
        Self { sessions, blocks, channels: self.channels.clone() }
    }

    /// The columns of simulated outputs, one response a session.
    pub(crate) fn columns(&self, responses: &[Response]) -> Columns {
        self.blocks
            .iter()
            .map(|b| {
                let values = responses.get(b.session).and_then(|r| r.get(&b.channel));
                values.cloned().unwrap_or_else(|| vec![0.0; b.measured.len()])
            })
            .collect()
    }

    /// Measured less simulated.
    pub(crate) fn residual(&self, simulated: &Columns) -> Columns {
        self.blocks
            .iter()
            .zip(simulated)
            .map(|(b, s)| b.measured.iter().zip(s).map(|(m, s)| m - s).collect())
            .collect()
    }

    /// What each sample of a block is for.
    pub(crate) fn uses(&self, block: &Block) -> &[Use] {
        &self.sessions[block.session].uses
    }

    /// Something about each fitted sample, in the order in which [`crate::noise::NoiseModel::stack`] stacks them, with the
    /// number of its block.
    pub(crate) fn stacked(&self, read: impl Fn(&Session, usize) -> f64) -> Vec<(usize, f64)> {
        let mut out = Vec::new();
        for (number, block) in self.blocks.iter().enumerate() {
            let session = &self.sessions[block.session];
            let fitted = (0..block.measured.len()).filter(|&i| session.uses.get(i) == Some(&Use::Fit));
            out.extend(fitted.map(|i| (number, read(session, i))));
        }
        out
    }

    /// Samples of a channel that are used so.
    pub(crate) fn count(&self, channel: Channel, wanted: Use) -> usize {
        let of = |b: &Block| self.uses(b).iter().filter(|u| **u == wanted).count();
        self.blocks.iter().filter(|b| b.channel == channel).map(of).sum()
    }
}

/// Outputs that the plant simulates under the log's inputs.
pub(crate) fn simulable(bench: &Bench, log: &MeasuredLog) -> Vec<Channel> {
    let channels = log.outputs().map(|(c, _)| c);
    match bench {
        Bench::Transmission(_) => {
            channels.filter(|c| !matches!(c, Channel::DriveTorque | Channel::BearingTemperature)).collect()
        }
        Bench::FrictionRig(rig) => {
            let effort = rig.channels().2;
            channels.filter(|c| *c == effort || *c == Channel::FrictionTorque).collect()
        }
    }
}

impl Session {
    fn new(bench: &Bench, log: &MeasuredLog, inputs: Inputs, fitted: bool, split: Option<Split>) -> Self {
        let times = &log.time_s;
        let motions: Vec<_> = times.iter().map(|&t| inputs.drive(t)).collect();
        let position: Vec<f64> = motions.iter().map(|m| m.value).collect();
        let phase = phases(times, &position);
        let start = times.first().copied().unwrap_or_default();
        let end = times.last().copied().unwrap_or_default();
        let (from, to) = match bench {
            Bench::Transmission(b) => (start + b.load.ramp_s + START_MARGIN_S, end - END_MARGIN_S),
            Bench::FrictionRig(_) => (start, end),
        };
        let cycles = phase.as_ref().map_or(0.0, |p| last_of(p) - p.first().copied().unwrap_or_default());
        // Whole cycles: the first half of them, rounded up, is fitted.
        let whole = (cycles + WHOLE_CYCLE).floor();
        let held_from =
            if whole >= 2.0 { start + (end - start) * (0.5 * whole).ceil() / cycles.max(1.0) } else { end };
        let block_s = (end - start) / BLOCKS as f64;
        let per_cycle = times.len() as f64 / cycles.max(1.0);
        let stretches = odd(STRETCHES.min(per_cycle / LEAST_STRETCH));
        let turn = |i: usize| phase.as_ref().and_then(|p| p.get(i)).map_or(0.0, |p| (p * stretches).floor());
        let uses = times
            .iter()
            .enumerate()
            .map(|(i, &t)| {
                if t < from || t > to {
                    Use::Skip
                } else if !fitted {
                    Use::Held
                } else if split.is_none() {
                    Use::Fit
                } else if whole >= 2.0 {
                    let fitted = if split == Some(Split::Turns) {
                        turn(i).rem_euclid(2.0) < 0.5
                    } else {
                        t < held_from
                    };
                    if fitted { Use::Fit } else { Use::Held }
                } else if ((t - start) / block_s) as usize % 2 == 1 {
                    Use::Held
                } else {
                    Use::Fit
                }
            })
            .collect();
        Self {
            number: 0,
            source: log.source.clone(),
            uses,
            phase,
            speed: motions.iter().map(|m| m.rate).collect(),
            load: times.iter().map(|&t| inputs.load_n(t)).collect(),
            position,
            inputs,
        }
    }
}

impl Session {
    /// Places of the fitted samples.
    pub(crate) fn fitted(&self) -> impl Iterator<Item = usize> {
        self.uses.iter().enumerate().filter(|(_, used)| **used == Use::Fit).map(|(i, _)| i)
    }

    /// Whether it has the two whole cycles of which one can be held out.
    pub(crate) fn is_halved(&self) -> bool {
        let cycles = self.phase.as_ref().map_or(0.0, |p| last_of(p) - p.first().copied().unwrap_or_default());
        cycles + WHOLE_CYCLE >= 2.0
    }

    /// Gives the first of its cycles, or the first eighth where it has not two, to its nuisances.
    fn settle(&mut self) {
        let used: Vec<usize> =
            (0..self.uses.len()).filter(|&i| self.uses.get(i) == Some(&Use::Held)).collect();
        let whole = self.phase.as_ref().and_then(|phase| {
            let start = *phase.get(*used.first()?)?;
            (last_of(phase) - start >= 2.0).then(|| phase.partition_point(|p| *p < start + 1.0))
        });
        let eighth = used.get(used.len() / SETTLING).copied().unwrap_or_default();
        let end = whole.unwrap_or(eighth);
        self.uses.iter_mut().take(end).filter(|u| **u == Use::Held).for_each(|u| *u = Use::Settle);
    }

    fn first(&self, count: usize) -> Self {
        let cut = |values: &[f64]| values.get(..count).unwrap_or(values).to_vec();
        Self {
            number: self.number,
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

/// The largest odd whole number up to a value, at least 1.
fn odd(value: f64) -> f64 {
    (2.0 * (0.5 * (value - 1.0)).floor() + 1.0).max(1.0)
}

fn last_of(values: &[f64]) -> f64 {
    values.last().copied().unwrap_or_default()
}
