//! The estimator with everything that watches over it: plausibility, envelope, virtual sensor, safe state.
//!
//! A sample goes through the estimator (which checks it first); the networks' force is held against the analytic law; the [`Tracker`]
//! learns from samples without a fault; what cannot be trusted is held. Every finding is a flag of its sample and a count of the
//! run ([`Monitor::health`]); what is learnt is reported by [`Monitor::report`]. No branch depends on data.
//!
//! Frames are calibrated: `host-sim`'s are, and on the controller the drivers' values go through the configuration's calibration first.

mod envelope;
mod limits;
mod safe_state;
mod tally;

use inference::held::read_anew;
use inference::{Flags, Model};
use link::track::{CHANNELS, ChannelCounts, MonitorConfiguration, SensorHealth, SensorStatus, TrackReport};
use link::{Configuration, EstimateFrame, Refusal, SensorFrame};

pub use envelope::Envelope;
pub use limits::ranges;

use crate::Estimator;
use crate::constants::Sum;
use crate::estimator::{Conditioning, Limits, SwingLimit, bearing_of, flags_of};
use crate::flags::{
    DISTRUSTED, IMPLAUSIBLE_POSITION, IMPLAUSIBLE_SWING, LOAD_CONTRADICTED, NETWORK_OUTSIDE_LAW,
    SENSOR_FAULT, SEQUENCE_GAP, TIME_FAULT,
};
use crate::tracking::Tracker;
use safe_state::Holding;
use tally::Tally;

/// An estimator under watch.
#[derive(Clone, Debug)]
pub struct Monitor {
    estimator: Estimator,
    envelope: Envelope,
    tracker: Tracker,
    holding: Holding,
    tally: Tally,
    /// Whether the networks were outside the envelope when they were last held against it.
    altered: bool,
    outside: bool,
    parity: u32,
    time_us: u32,
}

/// Lanes of the tally: five findings of four channels, then the sample's.
const CHANNEL_LANES: u32 = 5 * CHANNELS as u32;

impl Monitor {
    /// Creates the estimator for a bench from a model image, and what watches over it. `stuck_samples` is for journal and angle.
    ///
    /// # Errors
    ///
    /// A value of the configuration is out of range, or the image is damaged or made for another bearing. The monitor's own
    /// configuration is taken as validated ([`ranges`]).
    pub fn new(
        image: &'static [u8],
        configuration: &Configuration,
        monitor: &MonitorConfiguration,
        stuck_samples: u16,
    ) -> Result<Self, Refusal> {
        let bearing = bearing_of(configuration)?;
        let conditioning = Conditioning::of(bearing, monitor);
        let mut estimator = Estimator::conditioned(image, *configuration, &conditioning)?;
        estimator.plausibility_mut().set_limits(&limits_of(configuration, monitor, stuck_samples));
        Ok(Self {
            estimator,
            envelope: Envelope::new(configuration.radial_clearance_nm, monitor),
            tracker: Tracker::new(configuration, monitor),
            holding: Holding::new(monitor.recovery_samples, monitor.lost_samples),
            tally: Tally::default(),
            altered: false,
            outside: false,
            parity: 0,
            time_us: 0,
        })
    }

    /// Raises an alarm when the tracked friction level is above a limit, thousandths; 0 for none.
    pub fn limit_friction(&mut self, per_mille: u32) {
        self.tracker.limit_friction(per_mille);
    }

    /// What the configuration and the image set.
    pub(crate) fn constants(&self, sum: &mut Sum) {
        self.estimator.constants(sum);
        self.envelope.constants(sum);
        self.tracker.constants(sum);
        self.holding.constants(sum);
    }

    /// Says whether a bit of the networks is known not to be what it was: from the next sample on nothing they give is trusted.
    pub const fn note_altered(&mut self, altered: bool) {
        self.altered = altered;
    }

    /// Takes one sample, with what the drivers say of it, and estimates.
    pub fn step(&mut self, frame: &SensorFrame, status: SensorStatus) -> EstimateFrame {
        self.estimator.plausibility_mut().take_status(status);
        let mut estimate = self.estimator.step(frame);
        let parity = estimate.parity();
        let findings = *self.estimator.plausibility().findings();
        let flags = flags_of(&estimate);
        // In one sample of four; one outside stands until the next look.
        if self.tracker.is_idle() {
            self.outside = self.envelope.is_outside(&self.estimator.state(), estimate.normal_force_n)
                & !flags.intersects(envelope::EXCUSED);
        }
        let outside = self.outside;
        // The estimate does not rest on the load: what is wrong with it stops the tracker, and is flagged, but nothing is held.
        let flags = flags | NETWORK_OUTSIDE_LAW.when(outside) | Flags::ALTERED.when(self.altered);
        let distrusted = flags.intersects(DISTRUSTED);
        let flags = flags | findings.flags | LOAD_CONTRADICTED.when(self.tracker.is_contradicted());
        estimate.flags = flags.bits();
        self.tracker.step(frame, &estimate, !flags.intersects(SENSOR_FAULT));
        read_anew(&mut estimate);
        let spoilt = estimate.parity() != parity;
        estimate.flags |= Flags::ALTERED.when(spoilt).bits();
        let (held, begins, parity) = self.holding.apply(&mut estimate, distrusted | spoilt);
        self.parity = parity;
        self.time_us = frame.time_us;

        let sample = [
            flags.intersects(SEQUENCE_GAP),
            flags.intersects(TIME_FAULT),
            flags.intersects(IMPLAUSIBLE_POSITION),
            flags.intersects(IMPLAUSIBLE_SWING),
            outside,
            held,
            begins,
        ];
        let events = sample.iter().zip(CHANNEL_LANES..).fold(findings.events, |events, (happened, lane)| {
            events | u32::from(*happened).wrapping_shl(lane)
        });
        self.tally.add(events);
        estimate
    }
    /// Goes on with another model of the same bearing from the next sample on.
    pub fn switch(&mut self, model: Model<'static>) {
        self.estimator.switch(model);
    }

    /// What has been learnt about the bearing.
    #[must_use]
    pub fn report(&self) -> TrackReport {
        TrackReport { time_us: self.time_us, safe_state: self.holding.state(), ..self.tracker.report() }
    }

    /// What was wrong since the start.
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

    /// The parity of the last estimate, as it was computed.
    pub(crate) const fn parity(&self) -> u32 {
        self.parity
    }

    /// The estimator, to be given another model.
    pub const fn estimator_mut(&mut self) -> &mut Estimator {
        &mut self.estimator
    }

    /// The estimator, for what it conditioned.
    #[must_use]
    pub const fn estimator(&self) -> &Estimator {
        &self.estimator
    }
}

/// The limits of the sensors of a bench.
fn limits_of(configuration: &Configuration, monitor: &MonitorConfiguration, stuck_samples: u16) -> Limits {
    let stuck = u32::from(stuck_samples);
    let load_stuck = if monitor.load_stuck_samples == 0 { u32::MAX } else { monitor.load_stuck_samples };
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
