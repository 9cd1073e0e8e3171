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
