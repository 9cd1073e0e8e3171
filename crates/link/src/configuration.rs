//! Configuration of the controller: bench, calibration of the channels, limits.
//!
//! A [`ControllerConfiguration`] is checked completely before anything changes. A refusal carries
//! every reason at once ([`Reasons`]). The accepted ranges are those of
//! `controller::configuration`. All fields are integers with the unit in the name.

use serde::{Deserialize, Serialize};

use crate::track::{CHANNELS, MonitorConfiguration, MonitorField, SensorChannel};
use crate::{Wiring, WiringField};

/// Version of the layout and meaning of [`ControllerConfiguration`]. Records of other versions are
/// not read.
pub const CONFIGURATION_VERSION: u8 = 3;

/// Bench that the controller observes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BenchConfiguration {
    /// Bearing code: 0 Babbitt, 1 plastic.
    pub bearing: u8,
    /// Radial clearance, nm.
    pub radial_clearance_nm: u32,
    /// Journal radius, nm.
    pub journal_radius_nm: u32,
    /// Time between samples, us.
    pub sample_period_us: u32,
    /// Minimum approach speed that is latched at an onset, um/s.
    pub latch_floor_um_s: u32,
    /// Source of elastic force, damping and friction in the estimate.
    pub contact: ContactSource,
}

/// Source of elastic force, damping and friction in the estimate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ContactSource {
    /// The loaded model image; the analytic law gives the gradients.
    #[default]
    Network,
    /// The analytic law of the bearing's material.
    Law,
}

/// Calibration of a channel: `true = (raw - offset) * gain`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Calibration {
    /// Offset in the channel's unit: nm, nrad or mN.
    pub offset: i32,
    /// Gain in millionths; 1,000,000 leaves the value unchanged.
    pub gain_ppm: u32,
}

impl Calibration {
    /// Calibration that leaves every value unchanged.
    pub const NONE: Self = Self { offset: 0, gain_ppm: 1_000_000 };
}

/// Limits of a run, and the period of its reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Limits {
    /// Normal contact force above which an estimate is flagged, N; 0 for none.
    pub force_limit_n: u32,
    /// Friction level above which the slow telemetry raises an alarm, in thousandths of the trained
    /// friction; 0 for none.
    pub friction_level_limit_per_mille: u16,
    /// Number of consecutive late estimates that trips the controller; 0 for never.
    pub deadline_trip_count: u16,
    /// Number of samples with one unchanged code after which a sensor counts as stuck.
    pub stuck_samples: u16,
    /// Number of samples between two frames of slow telemetry; 0 for none.
    pub slow_every: u16,
}

impl Limits {
    /// No limit on forces, a trip after ten late estimates in a row, ten frames of slow telemetry a
    /// second at 10 kHz.
    pub const DEFAULT: Self = Self {
        force_limit_n: 0,
        friction_level_limit_per_mille: 0,
        deadline_trip_count: 10,
        stuck_samples: 100,
        slow_every: 1_000,
    };
}

/// Complete configuration of a controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ControllerConfiguration {
    /// [`CONFIGURATION_VERSION`].
    pub version: u8,
    /// Bench.
    pub bench: BenchConfiguration,
    /// Calibration by [`SensorChannel`].
    pub calibration: [Calibration; CHANNELS],
    /// Configuration of the monitor.
    pub monitor: MonitorConfiguration,
    /// Limits.
    pub limits: Limits,
    /// Wiring of the controller's own sensors.
    pub wiring: Wiring,
}

impl ControllerConfiguration {
    /// Creates the configuration of a bench with calibrated channels, default limits and default
    /// wiring.
    #[must_use]
    pub const fn new(bench: BenchConfiguration, monitor: MonitorConfiguration) -> Self {
        Self {
            version: CONFIGURATION_VERSION,
            bench,
            calibration: [Calibration::NONE; CHANNELS],
            monitor,
            limits: Limits::DEFAULT,
            wiring: Wiring::NOMINAL,
        }
    }
}

/// Field of a [`ControllerConfiguration`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Field {
    /// `version`.
    Version,
    /// `bench.bearing`.
    Bearing,
    /// `bench.radial_clearance_nm`.
    RadialClearance,
    /// `bench.journal_radius_nm`.
    JournalRadius,
    /// `bench.sample_period_us`.
    SamplePeriod,
    /// `bench.latch_floor_um_s`.
    LatchFloor,
    /// `calibration[channel].offset`.
    Offset(SensorChannel),
    /// `calibration[channel].gain_ppm`.
    Gain(SensorChannel),
    /// A field of `monitor`.
    Monitor(MonitorField),
    /// `limits.force_limit_n`.
    ForceLimit,
    /// `limits.friction_level_limit_per_mille`.
    FrictionLevelLimit,
    /// `limits.deadline_trip_count`.
    DeadlineTripCount,
    /// `limits.stuck_samples`.
    StuckSamples,
    /// `limits.slow_every`.
    SlowEvery,
    /// A field of `wiring`.
    Wiring(WiringField),
}

/// Value outside its accepted range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct OutOfRange {
    /// Field with the value.
    pub field: Field,
    /// Value found.
    pub found: i64,
    /// Minimum accepted value.
    pub min: i64,
    /// Maximum accepted value.
    pub max: i64,
}

/// Maximum number of reasons in one answer.
pub const MAX_REASONS: usize = 12;

/// Reasons of a refusal: every field that is out of range.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Reasons {
    /// Number of fields that are out of range.
    pub count: u8,
    /// First [`MAX_REASONS`] of them.
    pub first: [Option<OutOfRange>; MAX_REASONS],
}

impl Reasons {
    /// Adds a reason. Reasons beyond [`MAX_REASONS`] are only counted.
    pub fn add(&mut self, reason: OutOfRange) {
        if let Some(free) = self.first.get_mut(usize::from(self.count)) {
            *free = Some(reason);
        }
        self.count = self.count.saturating_add(1);
    }

    /// Iterates over the reasons that are stored.
    pub fn iter(&self) -> impl Iterator<Item = &OutOfRange> {
        self.first.iter().flatten()
    }
}

impl From<OutOfRange> for Reasons {
    fn from(reason: OutOfRange) -> Self {
        let mut reasons = Self::default();
        reasons.add(reason);
        reasons
    }
}

/// Accepted configuration, with the model and window that serve it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Configured {
    /// CRC-32 of the configuration in its serialised form.
    pub configuration_crc: u32,
    /// Model in use.
    pub model: crate::ModelId,
    /// Samples in the window of the networks.
    pub window: u16,
}
