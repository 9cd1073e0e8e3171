//! Source of a server's events: a run's samples, estimates and impacts.

use super::blocks::{DownSampler, Sizes};
use super::event::{Event, Start};
use super::history::History;
use link::{EstimateFrame, ImpactRecord, SensorFrame};
use std::sync::Arc;

/// Input of a server. What it holds back is sent when it is dropped, also if the run failed.
#[derive(Debug)]
pub(crate) struct Feed {
    history: Arc<History>,
    sampler: DownSampler,
}

impl Feed {
    /// Begins a run of so many samples, shown at `speed` simulated seconds per second.
    pub(super) fn begin(history: Arc<History>, mut start: Start, samples: u64, speed: f64) -> Self {
        let sizes = Sizes::new(samples, start.sample_rate_hz * speed);
        start.block_samples = sizes.block_samples;
        history.start(&Event::Start(start));
        Self { history, sampler: DownSampler::new(sizes) }
    }

    /// Takes a sample and its estimate.
    pub(crate) fn observe(&mut self, sample: &SensorFrame, estimate: &EstimateFrame) {
        if let Some(blocks) = self.sampler.push(sample, estimate) {
            self.history.push(&Event::Blocks(blocks));
        }
    }

    /// Takes the impacts that have ended.
    pub(crate) fn add_impacts(&mut self, ended: &[ImpactRecord]) {
        ended.iter().for_each(|impact| self.history.push(&Event::Impact(impact.into())));
    }
}

impl Drop for Feed {
    fn drop(&mut self) {
        if let Some(blocks) = self.sampler.finish() {
            self.history.push(&Event::Blocks(blocks));
        }
    }
}

/// Creates a feed, and a function that returns the numbers of the impacts and the count of the
/// samples that it has sent.
#[cfg(test)]
pub(crate) fn recorded() -> (Feed, impl Fn() -> (Vec<u64>, u64)) {
    use super::history::Position;
    let history = Arc::new(History::new("r".into(), usize::MAX));
    let start = Start {
        title: String::new(),
        controller: String::new(),
        duration_s: 1.0,
        clearance_nm: 0.0,
        sample_rate_hz: 1e4,
        block_samples: 0,
        flags: Vec::new(),
    };
    let feed = Feed::begin(Arc::clone(&history), start, 3, 1e3);
    let sent = move || {
        let text = history.read(Position::After(0), std::time::Duration::ZERO).text;
        let data = text.lines().filter_map(|line| line.strip_prefix("data: "));
        let events: Vec<serde_json::Value> =
            data.filter_map(|data| serde_json::from_str(data).ok()).collect();
        let impacts = events.iter().filter_map(|event| event["number"].as_u64()).collect();
        let samples = events.iter().filter_map(|event| event["samples"].as_array());
        (impacts, samples.flatten().filter_map(serde_json::Value::as_u64).sum())
    };
    (feed, sent)
}
