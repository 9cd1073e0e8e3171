//! One run: the estimator with its configuration, its deadline and its place in the stream of estimates.

use inference::{Bearing, Flags, Model, shipped};
use link::track::SensorStatus;
use link::{
    Configured, ControllerConfiguration, EstimateFrame, ModelId, NumberedEstimate, Refusal, Refused,
    SensorFrame,
};

use super::deadline::Deadline;
use crate::Estimator;
use crate::configuration::record;
use crate::estimator::WINDOW;
use crate::flags::{OVER_FORCE, STALE, TRIPPED};

/// A configured estimator at work.
#[derive(Debug)]
pub(super) struct Run {
    pub(super) configuration: ControllerConfiguration,
    pub(super) configured: Configured,
    pub(super) deadline: Deadline,
    estimator: Estimator,
    force_limit_n: f32,
    /// Number of the next estimate.
    number: u32,
    /// The last estimate that was in time.
    held: EstimateFrame,
}

impl Run {
    /// Starts a run with a configuration that has been validated. `watched_hz` is the frequency of the tick source; 0 for none.
    pub(super) fn new(configuration: ControllerConfiguration, watched_hz: u32) -> Result<Self, Refused> {
        let bench = configuration.bench;
        let bearing = Bearing::from_code(bench.bearing).ok_or(Refused::Image { cause: 0 })?;
        let estimator = Estimator::new(shipped(bearing), bench).map_err(|refusal| match refusal {
            Refusal::Image { cause } => Refused::Image { cause },
            // Validated before: a component that serves less than the validation promises is to be mended.
            _ => Refused::NotConfigured,
        })?;
        let limits = configuration.limits;
        let budget = u64::from(watched_hz).wrapping_mul(bench.sample_period_us.into()) / 1_000_000;
        let budget = u32::try_from(budget).unwrap_or(u32::MAX);
        let configured = Configured {
            configuration_crc: record::check_sum(&configuration),
            model: model_id(bearing),
            window: WINDOW as u16,
        };
        Ok(Self {
            configuration,
            configured,
            deadline: Deadline::new(budget, limits.deadline_trip_count),
            estimator,
            force_limit_n: if limits.force_limit_n == 0 {
                f32::INFINITY
            } else {
                limits.force_limit_n as f32
            },
            number: 0,
            held: EstimateFrame::default(),
        })
    }

    /// Estimates. Tripped, the last estimate that was in time stands for the new one, so that the link has time to be served.
    pub(super) fn estimate(&mut self, frame: &SensorFrame, _status: SensorStatus) -> EstimateFrame {
        if self.deadline.tripped() {
            let flags = self.held.flags | (STALE | TRIPPED).bits();
            return EstimateFrame { sequence: frame.sequence, time_us: frame.time_us, flags, ..self.held };
        }
        let mut estimate = self.estimator.step(frame);
        estimate.flags |= OVER_FORCE.when(estimate.normal_force_n > self.force_limit_n).bits();
        estimate
    }

    /// Marks an estimate that took `elapsed` ticks, keeps it if it was in time, and gives it its number.
    pub(super) fn number(&mut self, mut estimate: EstimateFrame, elapsed: u32) -> Numbered {
        let held = self.deadline.tripped();
        let late = self.deadline.is_late(elapsed);
        let trips = self.deadline.trips();
        estimate.flags |= (STALE.when(late) | TRIPPED.when(trips)).bits();
        estimate.instruction_ticks = self.deadline.whole_ticks();
        if !(late || held) {
            self.held = estimate;
        }
        let number = self.number;
        self.number = number.wrapping_add(1);
        Numbered { estimate: NumberedEstimate { number, dropped: 0, estimate }, late, trips, held }
    }
}

/// An estimate with what the session counts of it.
pub(super) struct Numbered {
    pub(super) estimate: NumberedEstimate,
    pub(super) late: bool,
    pub(super) trips: bool,
    pub(super) held: bool,
}

/// What a bearing's image says it is; zeros when it is refused.
pub(super) fn model_id(bearing: Bearing) -> ModelId {
    match Model::<i16>::load(shipped(bearing)) {
        Ok(model) => ModelId { crc: model.check_sum(), training_id: model.header().training_id },
        Err(_) => ModelId { crc: 0, training_id: 0 },
    }
}

/// The flags of an estimate as a set.
pub(super) const fn flags_of(estimate: &EstimateFrame) -> Flags {
    Flags::from_bits(estimate.flags)
}
