//! The estimator with everything that supervises it: plausibility, alarms, safe state.
//!
//! A sample goes through the estimator, which checks it first. The tracked clearance and friction
//! are compared with their limits ([`tracked`]). An estimate that cannot be trusted is replaced by
//! the last trusted one ([`safe_state`]). Every finding is a flag of its sample and is counted
//! ([`Monitor::health`]); [`Monitor::report`] gives the tracked quantities.
//!
//! Samples are already calibrated. The session applies the configuration's calibration to the
//! readings of the controller's own sensors; `host-sim` sends calibrated samples.

mod alarm;
mod limits;
mod safe_state;
mod tally;
mod tracked;

use inference::{Flags, Model};
use link::crc32::Digest;
use link::track::{CHANNELS, ChannelCounts, MonitorConfiguration, SensorHealth, SensorStatus, TrackReport};
use link::{BenchConfiguration, ContactSource, EstimateFrame, Refusal, SensorFrame};

pub use limits::ranges;

use crate::Estimator;
use crate::estimator::{Limits, SwingLimit, flags_of};
use crate::filter::Skew;
use crate::flags::{
    CONVERGING, DISTRUSTED, IMPLAUSIBLE_POSITION, IMPLAUSIBLE_SWING, MODEL_MISFIT, NETWORK_FAULT,
    NETWORK_OUTSIDE_LAW, SENSOR_FAULT, SEQUENCE_GAP, TIME_FAULT,
};
use crate::integrity::{WordSum, Words, read_anew, words};
use safe_state::{Holding, HoldingState};
use tally::Tally;
use tracked::{Tracked, TrackedState};

/// An estimator under supervision.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Monitor {
    estimator: Estimator,
    config: Config,
    tracked: TrackedState,
    holding: HoldingState,
    tally: Tally,
    /// True if the networks are known to be corrupted.
    are_networks_corrupted: bool,
    /// Word sum of the last estimate's values as they were computed.
    value_sum: WordSum,
    time_us: u32,
}

/// Constants of the monitor's own parts.
#[derive(Clone, Debug)]
struct Config {
    tracked: Tracked,
    holding: Holding,
    /// Flags with which no estimate is trusted.
    distrusted: Flags,
}
words!(Config { tracked, holding, distrusted });

/// Flags of estimates whose factors are not compared with limits.
const UNTRACKED: Flags = Flags::from_bits(SENSOR_FAULT.bits() | CONVERGING.bits() | MODEL_MISFIT.bits());

/// Lanes of the tally: five findings of four channels, then the sample's.
const CHANNEL_LANES: u32 = 5 * CHANNELS as u32;

impl Monitor {
    /// Creates the estimator for a bench from a model image, with its supervision.
    /// `stuck_samples` is for journal and angle.
    ///
    /// # Errors
    ///
    /// A value of the configuration is out of range, or the image is damaged or made for another
    /// bearing. The monitor's own configuration is taken as validated ([`ranges`]).
    pub fn new(
        image: &'static [u8],
        configuration: &BenchConfiguration,
        monitor: &MonitorConfiguration,
        stuck_samples: u16,
    ) -> Result<Self, Refusal> {
        let mut estimator = Estimator::new(image, configuration, monitor)?;
        estimator.plausibility_mut().set_limits(&limits_of(configuration, monitor, stuck_samples));
        Ok(Self {
            estimator,
            config: Config {
                tracked: Tracked::new(monitor),
                holding: Holding::new(monitor.recovery_samples.into(), monitor.lost_samples),
                distrusted: match configuration.contact {
                    ContactSource::Network => DISTRUSTED,
                    ContactSource::Law => Flags::from_bits(DISTRUSTED.bits() & !NETWORK_FAULT.bits()),
                },
            },
            tracked: TrackedState::default(),
            holding: HoldingState::default(),
            tally: Tally::default(),
            are_networks_corrupted: false,
            value_sum: WordSum::default(),
            time_us: 0,
        })
    }

    /// Sets the limit of the tracked friction level for its alarm, thousandths; 0 for none.
    pub fn limit_friction(&mut self, per_mille: u16) {
        self.config.tracked.limit_friction(per_mille);
    }

    /// Adds everything that configuration and image set to the CRC of the configuration.
    pub(crate) fn add_config_to(&self, crc: &mut Digest) {
        self.estimator.add_config_to(crc);
        self.config.add_to(crc);
    }

    /// Sets whether the networks are known to be corrupted. If so, no estimate is trusted from the
    /// next sample on.
    pub(crate) const fn set_networks_corrupted(&mut self, are_corrupted: bool) {
        self.are_networks_corrupted = are_corrupted;
    }

    /// Takes one sample with the status that the drivers report for it, and estimates.
    pub fn step(&mut self, frame: &SensorFrame, status: SensorStatus) -> EstimateFrame {
        self.estimator.plausibility_mut().set_status(status);
        let mut estimate = self.estimator.step(frame);
        let value_sum = sum_of(&estimate);
        let findings = *self.estimator.plausibility().findings();
        let flags = flags_of(&estimate);
        // A fault of the load alone is flagged, but nothing is held: the residual force covers it.
        let flags = flags | Flags::CORRUPTED.when(self.are_networks_corrupted);
        let is_distrusted = flags.intersects(self.config.distrusted);
        let flags = flags | findings.flags;
        estimate.flags = flags.bits();
        let counts = !flags.intersects(UNTRACKED) & !is_distrusted;
        self.config.tracked.step(&mut self.tracked, &estimate, counts);
        read_anew(&mut estimate);
        let is_corrupted = sum_of(&estimate) != value_sum;
        estimate.flags |= Flags::CORRUPTED.when(is_corrupted).bits();
        let (is_held, begins, value_sum) =
            self.config.holding.apply(&mut self.holding, &mut estimate, is_distrusted | is_corrupted);
        self.value_sum = value_sum;
        self.time_us = frame.time_us;

        let sample = [
            flags.intersects(SEQUENCE_GAP),
            flags.intersects(TIME_FAULT),
            flags.intersects(IMPLAUSIBLE_POSITION),
            flags.intersects(IMPLAUSIBLE_SWING),
            flags.intersects(NETWORK_OUTSIDE_LAW),
            is_held,
            begins,
        ];
        let events = sample.iter().zip(CHANNEL_LANES..).fold(findings.events, |events, (happened, lane)| {
            events | u32::from(*happened).wrapping_shl(lane)
        });
        self.tally.add(events);
        estimate
    }

    /// Continues with another model of the same bearing from the next sample on.
    pub(crate) fn switch(&mut self, model: Model<'static>) {
        self.estimator.switch(model);
    }

    /// Sets the time between the samples of the probes.
    pub(crate) const fn set_skew(&mut self, skew: Skew) {
        self.estimator.set_skew(skew);
    }

    /// The tracked clearance and friction level, and the safe state.
    #[must_use]
    pub fn report(&self) -> TrackReport {
        TrackReport {
            time_us: self.time_us,
            safe_state: self.config.holding.state(&self.holding),
            ..self.config.tracked.report(&self.tracked)
        }
    }

    /// Counts of every finding since the start.
    #[must_use]
    pub fn health(&self) -> SensorHealth {
        let count = |lane: u32| self.tally.count(lane);
        let channel = |index: u32| ChannelCounts {
            missing: count(index),
            saturated: count(index + 4),
            stuck: count(index + 8),
            noisy: count(index + 12),
            jumped: count(index + 16),
        };
        SensorHealth {
            time_us: self.time_us,
            channels: [channel(0), channel(1), channel(2), channel(3)],
            sequence_gaps: count(CHANNEL_LANES),
            time_faults: count(CHANNEL_LANES + 1),
            implausible_positions: count(CHANNEL_LANES + 2),
            implausible_swings: count(CHANNEL_LANES + 3),
            outside_law: count(CHANNEL_LANES + 4),
            held: count(CHANNEL_LANES + 5),
            holds: count(CHANNEL_LANES + 6),
        }
    }

    /// Word sum of the last estimate's values as they were computed.
    pub(crate) const fn value_sum(&self) -> WordSum {
        self.value_sum
    }

    /// Returns the rate of the deformation at the last sample, m/s.
    #[inline]
    pub(crate) const fn deformation_rate_m_s(&self) -> f32 {
        self.estimator.sample().deformation_rate_nm_s as f32 * 1e-9
    }

    /// Estimator, to read its contact.
    #[must_use]
    pub const fn estimator(&self) -> &Estimator {
        &self.estimator
    }
}

/// Returns the word sum of the values of an estimate.
#[inline]
fn sum_of(estimate: &EstimateFrame) -> WordSum {
    WordSum::from_words(&estimate.value_bits())
}

/// The limits of the sensors of a bench.
fn limits_of(
    configuration: &BenchConfiguration,
    monitor: &MonitorConfiguration,
    stuck_samples: u16,
) -> Limits {
    let stuck = u32::from(stuck_samples);
    let load_stuck =
        if monitor.load_stuck_samples == 0 { u32::MAX } else { monitor.load_stuck_samples.into() };
    let journal = (monitor.journal_noise_limit_nm, monitor.journal_rail_nm);
    let lever_ratio = monitor.load_lever_um as f32 / monitor.drive_lever_um as f32;
    Limits {
        stuck_samples: [stuck, stuck, stuck, load_stuck],
        noise: [journal.0, journal.0, monitor.angle_noise_limit_nrad, monitor.load_noise_limit_mn],
        rail: [journal.1, journal.1, u32::MAX, monitor.load_rail_mn],
        swing: SwingLimit {
            radial_clearance_m: configuration.radial_clearance_nm as f32 * 1e-9,
            journal_radius_m: configuration.journal_radius_nm as f32 * 1e-9,
            per_load: (1.0 - lever_ratio).abs() / (monitor.mass_g as f32 * 1e-3),
        },
    }
}
