//! One run: estimator, configuration, deadline and numbering of the estimates.

use inference::{BearingMaterial, Flags, ImageError, WINDOW};
use link::crc32::Digest;
use link::track::SensorStatus;
use link::{
    BlockSummary, Configured, ControllerConfiguration, ESTIMATE_FRAME, EstimateFrame, Field,
    NumberedEstimate, OutOfRange, Reasons, Refusal, SensorFrame,
};

use super::deadline::Deadline;
use crate::Monitor;
use crate::boards::LINK_BAUD;
use crate::configuration::{Calibrator, checksum, wiring};
use crate::estimator::SAMPLE_PERIOD_RANGE_US;
use crate::filter::Skew;
use crate::flags::{OVER_FORCE, STALE, TRIPPED};
use crate::impacts::{Block, Found, ImpactTracker};
use crate::integrity::{Guarded, WordSum, Words};
use crate::store::{Loaded, Models, Scrubber};

/// Shortest time between two sent estimates of own samples, us: with its block at most 69 % of
/// what the serial line carries.
const OWN_ESTIMATE_PERIOD_US: u32 = 4_000;

/// Longest frame of a block on the wire, bytes.
const BLOCK_FRAME: usize = 1 + 5 + 4 + 4 + 5 + 3 + 3 + 4 + 2;
/// A byte takes ten bits on the serial line. Three tenths of the line are left for impacts,
/// telemetry and answers.
const _: () = assert!(
    1_000_000 / OWN_ESTIMATE_PERIOD_US * (ESTIMATE_FRAME + BLOCK_FRAME) as u32 <= LINK_BAUD / 10 * 7 / 10
);

/// Returns the number of own samples per sent estimate at a sample period in us; 1 or more.
#[must_use]
pub fn own_estimate_interval(sample_period_us: u32) -> u16 {
    // At most 4,000.
    OWN_ESTIMATE_PERIOD_US.div_ceil(sample_period_us.max(1)) as u16
}

/// The controller's own samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OwnSampling {
    /// Shortest period, us.
    pub shortest_period_us: u32,
    /// Time from the sample of the first probe to that of the second, ns.
    pub input_interval_ns: u32,
}

/// A configured estimator at work.
#[derive(Debug)]
#[repr(C)]
pub(super) struct Run {
    pub(super) monitor: Monitor,
    pub(super) configuration: ControllerConfiguration,
    pub(super) configured: Configured,
    pub(super) deadline: Deadline,
    calibrator: Calibrator,
    scrubber: Scrubber,
    is_model_corrupted: bool,
    /// True until the corruption has been reported.
    has_new_corruption: bool,
    bearing: BearingMaterial,
    force_limit_n: f32,
    /// Number of the next estimate to be sent.
    next_number: u32,
    /// True if the run uses the samples of the controller's sensors.
    is_sampling: bool,
    /// Estimates since the last one that was sent.
    withheld: u16,
    /// The last estimate in time.
    last_in_time: EstimateFrame,
    /// Word sum of its values as they were computed.
    last_in_time_sum: WordSum,
    /// Word sum of the values of the next estimate to be sent.
    value_sum: WordSum,
    block: Block,
    impacts: ImpactTracker,
    /// CRC-32 of everything that the configuration sets.
    config_crc: u32,
}

impl Run {
    /// Starts a run with a validated configuration. `watched_hz` is the frequency of the tick
    /// source; 0 without one.
    pub(super) fn new(
        configuration: ControllerConfiguration,
        models: &Models,
        watched_hz: u32,
    ) -> Result<Self, Refusal> {
        let bench = configuration.bench;
        let bearing =
            BearingMaterial::from_code(bench.bearing).ok_or(Refusal::Image { cause: ImageError::BEARING })?;
        let &Loaded { image, .. } = models.of(bearing).ok_or(Refusal::Image { cause: ImageError::CRC })?;
        let limits = configuration.limits;
        let mut monitor = Monitor::new(image, &bench, &configuration.monitor, limits.stuck_samples)?;
        monitor.limit_friction(limits.friction_level_limit_per_mille);
        let budget = u64::from(watched_hz).wrapping_mul(bench.sample_period_us.into()) / 1_000_000;
        let budget = u32::try_from(budget).unwrap_or(u32::MAX);
        let configured = Configured {
            configuration_crc: checksum(&configuration),
            model: models.id(bearing),
            window: WINDOW as u16,
        };
        let mut run = Self {
            configuration,
            configured,
            deadline: Deadline::new(budget, limits.deadline_trip_count),
            monitor,
            calibrator: Calibrator::new(&configuration.calibration),
            scrubber: Scrubber::new(image),
            is_model_corrupted: false,
            has_new_corruption: false,
            bearing,
            force_limit_n: if limits.force_limit_n == 0 {
                f32::INFINITY
            } else {
                limits.force_limit_n as f32
            },
            next_number: 0,
            is_sampling: false,
            withheld: 0,
            last_in_time: EstimateFrame::UNKNOWN,
            last_in_time_sum: WordSum::from_words(&EstimateFrame::UNKNOWN.value_bits()),
            value_sum: WordSum::default(),
            block: Block::default(),
            impacts: ImpactTracker::default(),
            config_crc: 0,
        };
        run.config_crc = run.compute_config_crc();
        Ok(run)
    }

    /// Computes the CRC-32 of everything that the configuration sets.
    fn compute_config_crc(&self) -> u32 {
        let mut crc = Digest::default();
        self.monitor.add_config_to(&mut crc);
        self.calibrator.add_config_to(&mut crc);
        self.deadline.add_config_to(&mut crc);
        self.bearing.code().add_to(&mut crc);
        self.is_sampling.add_to(&mut crc);
        self.configuration.bench.sample_period_us.add_to(&mut crc);
        self.configuration.limits.slow_every.add_to(&mut crc);
        self.force_limit_n.add_to(&mut crc);
        crc.value()
    }

    /// Changes what the configuration sets. A corruption from before the change stays detectable.
    fn change_configuration(&mut self, change: impl FnOnce(&mut Self)) {
        let is_corrupted = self.is_configuration_corrupted();
        change(self);
        self.config_crc = self.compute_config_crc() ^ u32::from(is_corrupted);
    }

    /// Returns true if a bit of what the configuration sets has flipped.
    pub(super) fn is_configuration_corrupted(&self) -> bool {
        self.compute_config_crc() != self.config_crc
    }

    /// Estimates. In a tripped run the last estimate in time is repeated, so that the link has time
    /// to be served.
    pub(super) fn estimate(&mut self, frame: &SensorFrame, status: SensorStatus) -> EstimateFrame {
        if self.deadline.is_tripped() {
            let flags = self.last_in_time.flags | (STALE | TRIPPED).bits();
            let (sequence, time_us) = (frame.sequence, frame.time_us);
            let held = EstimateFrame { sequence, time_us, flags, ..self.last_in_time };
            self.value_sum = self.last_in_time_sum;
            return held;
        }
        self.monitor.set_networks_corrupted(self.is_model_corrupted);
        let mut estimate = self.monitor.step(&self.calibrator.apply(frame), status);
        self.value_sum = self.monitor.value_sum();
        let is_corrupted = self.scrubber.step();
        self.has_new_corruption |= is_corrupted & !self.is_model_corrupted;
        self.is_model_corrupted |= is_corrupted;
        estimate.flags |= Flags::CORRUPTED.when(self.is_model_corrupted).bits();
        estimate.flags |= OVER_FORCE.when(estimate.normal_force_n > self.force_limit_n).bits();
        estimate
    }

    /// Word sum of the last estimate's values as they were computed.
    #[inline]
    pub(super) const fn value_sum(&self) -> WordSum {
        self.value_sum
    }

    /// Continues with the controller's own samples. Returns the number of samples per sent
    /// estimate. Refused if a tick takes longer than the bench's period.
    pub(super) fn start_sampling(&mut self, own: &OwnSampling) -> Result<u16, Reasons> {
        let OwnSampling { shortest_period_us, input_interval_ns } = *own;
        let period_us = self.configuration.bench.sample_period_us;
        if period_us < shortest_period_us {
            let (found, min) = (period_us.into(), shortest_period_us.into());
            let max = *SAMPLE_PERIOD_RANGE_US.end();
            return Err(OutOfRange { field: Field::SamplePeriod, found, min, max }.into());
        }
        let directions = wiring(&self.configuration).map(|wiring| wiring.geometry.second_direction());
        let skew = Skew::new(directions.unwrap_or_default(), input_interval_ns as f32 * 1e-9);
        self.change_configuration(|run| {
            run.is_sampling = true;
            run.monitor.set_skew(skew);
        });
        self.block = Block::default();
        Ok(own_estimate_interval(period_us))
    }

    /// Decides whether the run uses the controller's own samples.
    pub(super) const fn is_sampling(&self) -> bool {
        self.is_sampling
    }

    /// Counts the estimate of an own sample and returns whether it is sent. If not, the next
    /// estimate takes its number.
    pub(super) fn take_turn(&mut self) -> bool {
        self.withheld = self.withheld.saturating_add(1);
        let sends = self.withheld >= own_estimate_interval(self.configuration.bench.sample_period_us);
        if sends {
            self.withheld = 0;
        } else {
            self.next_number = self.next_number.wrapping_sub(1);
        }
        sends
    }

    /// Makes the deviations of the estimate that a trip repeats infinite. A corruption from before
    /// stays detectable.
    fn forget_deviations(&mut self) {
        let is_corrupted = WordSum::from_words(&self.last_in_time.value_bits()) != self.last_in_time_sum;
        self.last_in_time.forget_deviations();
        self.last_in_time_sum = WordSum::from_words(&self.last_in_time.value_bits()).marked(is_corrupted);
    }

    /// Returns the last estimate in time; unknown before the first.
    pub(super) const fn last(&self) -> &EstimateFrame {
        &self.last_in_time
    }

    /// Switches to other networks. If there are none for the bearing, the corrupted ones stay in
    /// use: their estimates are flagged, and the last trusted one is held.
    pub(super) fn switch(&mut self, models: &Models) {
        self.configured.model = models.id(self.bearing);
        match models.of(self.bearing) {
            Some(&Loaded { image, model }) => {
                self.change_configuration(|run| run.monitor.switch(model));
                self.scrubber = Scrubber::new(image);
                self.is_model_corrupted = false;
            }
            None => self.is_model_corrupted = true,
        }
    }

    /// Returns true once when the model is found corrupted.
    pub(super) const fn take_model_corruption(&mut self) -> bool {
        core::mem::replace(&mut self.has_new_corruption, false)
    }

    /// Marks and numbers an estimate that took `elapsed` ticks, and stores it if it was in time.
    pub(super) fn finish_estimate(&mut self, mut estimate: EstimateFrame, elapsed: u32) -> TimedEstimate {
        let is_held = self.deadline.is_tripped();
        let is_late = self.deadline.record_elapsed(elapsed);
        let trips = self.deadline.trip_if_due();
        estimate.flags |= (STALE.when(is_late) | TRIPPED.when(trips)).bits();
        estimate.instruction_ticks = self.deadline.total_ticks();
        if !(is_late || is_held) {
            (self.last_in_time, self.last_in_time_sum) = (estimate, self.value_sum);
        }
        if trips {
            self.forget_deviations();
        }
        let number = self.next_number;
        self.next_number = number.wrapping_add(1);
        TimedEstimate { estimate: NumberedEstimate { number, dropped: 0, estimate }, is_late, trips, is_held }
    }

    /// Adds the last estimate to the block of own samples and looks for impacts.
    #[inline]
    pub(super) fn follow_impacts(&mut self, estimate: &EstimateFrame) -> Option<Found> {
        self.block.add(estimate);
        self.impacts.step(estimate, self.monitor.deformation_rate_m_s())
    }

    /// Ends the block at the estimate that is sent.
    pub(super) fn take_block(&mut self) -> Guarded<BlockSummary> {
        self.block.take(self.next_number.wrapping_sub(1))
    }

    /// Ends an open impact with the run.
    pub(super) fn finish_impacts(&mut self) -> Option<Found> {
        self.impacts.finish()
    }
}

/// A numbered estimate with what telemetry counts.
pub(super) struct TimedEstimate {
    pub(super) estimate: NumberedEstimate,
    pub(super) is_late: bool,
    pub(super) trips: bool,
    pub(super) is_held: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::configuration::BENCH_B;

    const OWN: OwnSampling = OwnSampling { shortest_period_us: 100, input_interval_ns: 9_000 };

    fn run() -> Run {
        Run::new(BENCH_B, &Models::built_in(), 0).unwrap()
    }

    #[test]
    fn two_flipped_bits_of_the_configuration_that_cancel_in_a_word_sum_are_detected() {
        let mut run = run();
        assert!(!run.is_configuration_corrupted());
        // A word sum rotates by 7 bits from one of these neighbours to the other.
        run.configuration.limits.slow_every ^= 1;
        run.force_limit_n = f32::from_bits(run.force_limit_n.to_bits() ^ 1 << 7);
        assert!(run.is_configuration_corrupted());
    }

    #[test]
    fn a_flip_in_the_period_that_paces_the_samples_is_detected() {
        for bit in 0..32 {
            let mut run = run();
            run.configuration.bench.sample_period_us ^= 1 << bit;
            assert!(run.is_configuration_corrupted(), "bit {bit}");
        }
    }

    #[test]
    fn own_samples_take_the_time_between_the_probes_into_account() {
        let mut sampling = run();
        sampling.start_sampling(&OWN).unwrap();
        let mut expected = run();
        expected.change_configuration(|run| {
            run.is_sampling = true;
            // The first probe is along Y, so the second one is along Z.
            run.monitor.set_skew(Skew::new([0.0, 1.0], 9_000.0 * 1e-9));
        });
        assert_eq!(sampling.config_crc, expected.config_crc);
        expected.change_configuration(|run| run.monitor.set_skew(Skew::default()));
        assert_ne!(sampling.config_crc, expected.config_crc);
    }

    #[test]
    fn an_intended_change_of_the_configuration_does_not_hide_a_corruption() {
        let changes: [fn(&mut Run); 2] =
            [|run| assert_eq!(run.start_sampling(&OWN), Ok(40)), |run| run.switch(&Models::built_in())];
        for (number, change) in changes.into_iter().enumerate() {
            let mut run = run();
            change(&mut run);
            assert!(!run.is_configuration_corrupted(), "change {number}");
            run.configuration.limits.slow_every ^= 1;
            change(&mut run);
            assert!(run.is_configuration_corrupted(), "change {number}");
            change(&mut run);
            assert!(run.is_configuration_corrupted(), "change {number}, repeated");
        }
    }
}
