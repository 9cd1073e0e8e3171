//! One run: the estimator with its configuration, its deadline and its place in the stream of estimates.

use core::hash::Hash;

use inference::{Bearing, Flags};
use link::track::SensorStatus;
use link::{
    Configured, ControllerConfiguration, EstimateFrame, Field, NumberedEstimate, OutOfRange, Reasons,
    Refusal, Refused, SensorFrame,
};

use super::deadline::Deadline;
use crate::Monitor;
use crate::configuration::{Calibrator, check_sum};
use crate::constants::Sum;
use crate::estimator::WINDOW;
use crate::flags::{OVER_FORCE, STALE, TRIPPED};
use crate::store::{Loaded, Models, Scrubber};

/// Time between samples that the controller takes itself, us: a timer tick.
pub const OWN_PERIOD_US: u32 = 100;
/// Of its own samples' estimates one in so many is sent: 500 a second, half of what the serial line carries.
pub const OWN_EVERY: u16 = 20;

/// A configured estimator at work.
#[derive(Debug)]
pub(super) struct Run {
    pub(super) configuration: ControllerConfiguration,
    pub(super) configured: Configured,
    pub(super) deadline: Deadline,
    pub(super) monitor: Monitor,
    calibrator: Calibrator,
    scrubber: Scrubber,
    altered: bool,
    /// Whether that has not been told yet.
    altered_is_news: bool,
    bearing: Bearing,
    force_limit_n: f32,
    /// Number of the next estimate.
    number: u32,
    /// Whether the samples are the controller's own.
    samples_itself: bool,
    /// Estimates since the last one that was sent.
    withheld: u16,
    /// The last estimate that was in time.
    held: EstimateFrame,
    /// Of that one, as it was computed.
    held_parity: u32,
    /// Of the one that goes out next.
    parity: u32,
}

impl Run {
    /// Starts a run with a configuration that has been validated. `watched_hz` is the frequency of the tick source; 0 for none.
    pub(super) fn new(
        configuration: ControllerConfiguration,
        models: &Models,
        watched_hz: u32,
    ) -> Result<Self, Refused> {
        let bench = configuration.bench;
        let bearing = Bearing::from_code(bench.bearing).ok_or(Refused::Image { cause: 0 })?;
        let &Loaded { image, .. } = models.of(bearing).ok_or(Refused::Image { cause: 4 })?;
        let limits = configuration.limits;
        let mut monitor =
            Monitor::new(image, &bench, &configuration.monitor, limits.stuck_samples).map_err(|refusal| {
                match refusal {
                    Refusal::Image { cause } => Refused::Image { cause },
                    // Validated before, by the same ranges.
                    Refusal::OutOfRange(reason) => {
                        let mut reasons = Reasons::default();
                        reasons.add(reason);
                        Refused::Configuration(reasons)
                    }
                }
            })?;
        monitor.limit_friction(limits.friction_level_limit_per_mille);
        let budget = u64::from(watched_hz).wrapping_mul(bench.sample_period_us.into()) / 1_000_000;
        let budget = u32::try_from(budget).unwrap_or(u32::MAX);
        let configured = Configured {
            configuration_crc: check_sum(&configuration),
            model: models.id(bearing),
            window: WINDOW as u16,
        };
        Ok(Self {
            configuration,
            configured,
            deadline: Deadline::new(budget, limits.deadline_trip_count),
            monitor,
            calibrator: Calibrator::new(&configuration.calibration),
            scrubber: Scrubber::new(image),
            altered: false,
            altered_is_news: false,
            bearing,
            force_limit_n: if limits.force_limit_n == 0 {
                f32::INFINITY
            } else {
                limits.force_limit_n as f32
            },
            number: 0,
            samples_itself: false,
            withheld: 0,
            held: EstimateFrame::default(),
            held_parity: 0,
            parity: 0,
        })
    }

    /// Sum of what must stay as long as the run.
    pub(super) fn constants(&self) -> u32 {
        let mut sum = Sum::new();
        self.monitor.constants(&mut sum);
        self.calibrator.constants(&mut sum);
        self.deadline.constants(&mut sum);
        (self.bearing.code(), self.samples_itself, self.configuration.limits.slow_every).hash(&mut sum);
        sum.float(self.force_limit_n);
        sum.sum()
    }

    /// Estimates. Tripped, the last estimate that was in time stands for the new one, so that the link has time to be served.
    pub(super) fn estimate(&mut self, frame: &SensorFrame, status: SensorStatus) -> EstimateFrame {
        if self.deadline.tripped() {
            self.parity = self.held_parity;
            let flags = self.held.flags | (STALE | TRIPPED).bits();
            return EstimateFrame { sequence: frame.sequence, time_us: frame.time_us, flags, ..self.held };
        }
        self.monitor.note_altered(self.altered);
        let mut estimate = self.monitor.step(&self.calibrator.apply(frame), status);
        self.parity = self.monitor.parity();
        let altered = self.scrubber.step();
        self.altered_is_news |= altered & !self.altered;
        self.altered |= altered;
        estimate.flags |= Flags::ALTERED.when(self.altered).bits();
        estimate.flags |= OVER_FORCE.when(estimate.normal_force_n > self.force_limit_n).bits();
        estimate
    }

    /// The parity of the estimate that was given last.
    #[inline]
    pub(super) const fn parity(&self) -> u32 {
        self.parity
    }

    /// Goes on with the controller's own samples; refused if the bench's period is not theirs.
    pub(super) fn sample_itself(&mut self) -> Result<(), Reasons> {
        let (found, own) = (self.configuration.bench.sample_period_us.into(), OWN_PERIOD_US.into());
        if found == own {
            self.samples_itself = true;
            return Ok(());
        }
        let mut reasons = Reasons::default();
        reasons.add(OutOfRange { field: Field::SamplePeriod, found, min: own, max: own });
        Err(reasons)
    }

    /// Whether the samples are the controller's own.
    pub(super) const fn samples_itself(&self) -> bool {
        self.samples_itself
    }

    /// Whether the estimate of an own sample is sent. One that is not leaves its number to the next.
    pub(super) const fn sends(&mut self) -> bool {
        self.withheld = self.withheld.saturating_add(1);
        let sends = self.withheld >= OWN_EVERY;
        if sends {
            self.withheld = 0;
        } else {
            self.number = self.number.wrapping_sub(1);
        }
        sends
    }

    /// The last estimate that was in time; all zeros before the first.
    pub(super) const fn last(&self) -> &EstimateFrame {
        &self.held
    }

    /// Goes on with other networks; without any, with the altered ones: flagged, and the last trusted estimate held.
    pub(super) fn switch(&mut self, models: &Models) {
        self.configured.model = models.id(self.bearing);
        match models.of(self.bearing) {
            Some(&Loaded { image, model }) => {
                self.monitor.switch(model);
                self.scrubber = Scrubber::new(image);
                self.altered = false;
            }
            None => self.altered = true,
        }
    }

    /// Whether the model has been found altered since this was asked last.
    pub(super) const fn take_altered(&mut self) -> bool {
        core::mem::replace(&mut self.altered_is_news, false)
    }

    /// Marks an estimate that took `elapsed` ticks, keeps it if it was in time, and gives it its number.
    pub(super) fn number(&mut self, mut estimate: EstimateFrame, elapsed: u32) -> Numbered {
        let held = self.deadline.tripped();
        let late = self.deadline.is_late(elapsed);
        let trips = self.deadline.trips();
        estimate.flags |= (STALE.when(late) | TRIPPED.when(trips)).bits();
        estimate.instruction_ticks = self.deadline.whole_ticks();
        if !(late || held) {
            (self.held, self.held_parity) = (estimate, self.parity);
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

/// The flags of an estimate as a set.
pub(super) const fn flags_of(estimate: &EstimateFrame) -> Flags {
    Flags::from_bits(estimate.flags)
}
