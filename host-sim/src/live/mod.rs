//! Live views of a run: the terminal and the pages of browsers, at one pace.
//!
//! A view observes every sample with its estimate and the impacts that have ended. The run is paced
//! here, so that both views show the same moment. No view changes a result.

pub(crate) mod pace;

use crate::serve::feed::Feed;
use crate::watch::Watch;
use link::{EstimateFrame, ImpactRecord, SensorFrame};
use pace::Pace;
use std::ops::ControlFlow;

/// Open views of a run, at least one.
pub(crate) struct LiveViews {
    pace: Pace,
    watch: Option<Watch>,
    feed: Option<Feed>,
    /// Number of impacts that the views have received.
    impacts: usize,
}

impl LiveViews {
    /// Combines the open views; `None` without one.
    pub(crate) fn new(watch: Option<Watch>, feed: Option<Feed>, pace: Pace) -> Option<Self> {
        let is_open = watch.is_some() || feed.is_some();
        is_open.then_some(Self { pace, watch, feed, impacts: 0 })
    }

    /// Shows a sample, its estimate and the impacts that have ended, and waits for the sample's
    /// time. `Break` ends the run.
    pub(crate) fn observe(
        &mut self,
        sample: &SensorFrame,
        estimate: &EstimateFrame,
        ended: &[ImpactRecord],
    ) -> ControlFlow<()> {
        self.impacts += ended.len();
        if let Some(feed) = &mut self.feed {
            feed.observe(sample, estimate);
            feed.add_impacts(ended);
        }
        let due = self.pace.due(f64::from(sample.time_us) * 1e-6);
        if let Some(watch) = &mut self.watch {
            watch.observe(sample, estimate, ended, due)?;
        }
        if self.feed.is_some() {
            pace::wait_until(due);
        }
        ControlFlow::Continue(())
    }

    /// Closes the views after the last sample. `impacts` are all of the run: those that ended with
    /// it have not been observed.
    pub(crate) fn finish(mut self, impacts: &[ImpactRecord]) {
        if let Some(feed) = &mut self.feed {
            feed.add_impacts(impacts.get(self.impacts..).unwrap_or_default());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::serve::feed;

    #[test]
    fn an_impact_that_ends_with_the_run_is_shown_as_well_and_none_twice() {
        let (feed, sent) = feed::recorded();
        let mut views = LiveViews::new(None, Some(feed), Pace::new(1e3).unwrap()).unwrap();
        let impact = |number| ImpactRecord { number, ..ImpactRecord::default() };
        let all = [impact(0), impact(1), impact(2)];
        for (sequence, ended) in [(0, &all[..1]), (1, &[]), (2, &all[1..2])] {
            let sample = SensorFrame { sequence, time_us: 100 * sequence, ..SensorFrame::default() };
            assert!(views.observe(&sample, &EstimateFrame::default(), ended).is_continue());
        }
        views.finish(&all);
        let (impacts, samples) = sent();
        assert_eq!((impacts, samples), (vec![0, 1, 2], 3));
        assert!(LiveViews::new(None, None, Pace::new(1.0).unwrap()).is_none());
    }
}
