//! What the controller is told: the bench, the channels' calibration, the limits.
//!
//! A [`ControllerConfiguration`] is checked as a whole before anything changes, and refused with every reason at once
//! ([`Reasons`]). The ranges that are served are those of `firmware::configuration`. Whole numbers, the unit in the name.

use serde::{Deserialize, Serialize};

use crate::track::{CHANNELS, MonitorConfiguration, MonitorField, SensorChannel};
use crate::{Wiring, WiringField};

/// Version of the layout and meaning of [`ControllerConfiguration`]; a record of another version is not read.
pub const CONFIGURATION_VERSION: u8 = 2;

/// The bench that the controller is beside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Configuration {
    /// Bearing code: 0 Babbitt, 1 plastic.
    pub bearing: u8,
    /// Radial clearance, nm.
    pub radial_clearance_nm: u32,
    /// Journal radius, nm.
    pub journal_radius_nm: u32,
    /// Time between samples, us.
    pub sample_period_us: u32,
    /// Least approach speed that is latched at an onset, um/s.
    pub latch_floor_um_s: u32,
    /// Approach speed assumed for a contact whose onset was not seen, um/s: what is known of how the bench starts.
    pub unseen_approach_um_s: u32,
}

/// How a channel's raw value becomes the true one: `true = (raw - offset) * gain`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Calibration {
    /// Offset in the channel's unit: nm, nrad or mN.
    pub offset: i32,
    /// Gain, millionths: 1,000,000 leaves the value as it is.
    pub gain_ppm: u32,
}

impl Calibration {
    /// Leaves every value as it is.
    pub const NONE: Self = Self { offset: 0, gain_ppm: 1_000_000 };
}

/// Limits of the session and how often it reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Limits {
    /// Normal contact force above which an estimate is flagged, N; 0 for none.
    pub force_limit_n: u32,
    /// Friction level above which the slow telemetry says so, thousandths of the trained friction; 0 for none.
    pub friction_level_limit_per_mille: u32,
    /// Late estimates one after the other at which the controller trips; 0 for never.
    pub deadline_trip_count: u16,
    /// Samples of one unchanging code after which a sensor counts as stuck.
    pub stuck_samples: u16,
    /// Samples from one frame of slow telemetry to the next; 0 for none.
    pub slow_every: u16,
}

impl Limits {
    /// No limit on the forces, a trip after ten late estimates in a row, slow telemetry ten times a second at 10 kHz.
    pub const DEFAULT: Self = Self {
        force_limit_n: 0,
        friction_level_limit_per_mille: 0,
        deadline_trip_count: 10,
        stuck_samples: 100,
        slow_every: 1_000,
    };
}

/// Everything the controller is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ControllerConfiguration {
    /// [`CONFIGURATION_VERSION`].
    pub version: u8,
    /// The bench.
    pub bench: Configuration,
    /// By [`SensorChannel`].
    pub calibration: [Calibration; CHANNELS],
    /// What the monitor has to know.
    pub monitor: MonitorConfiguration,
    /// Limits.
    pub limits: Limits,
    /// The controller's own sensors.
    pub wiring: Wiring,
}

impl ControllerConfiguration {
    /// A bench with calibrated channels, the limits and the wiring left as they are.
    #[must_use]
    pub const fn new(bench: Configuration, monitor: MonitorConfiguration) -> Self {
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

/// A field of a [`ControllerConfiguration`].
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
    /// `bench.unseen_approach_um_s`.
    UnseenApproach,
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

/// A value that cannot be served.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct OutOfRange {
    /// Which.
    pub field: Field,
    /// Found.
    pub found: i64,
    /// Least.
    pub min: i64,
    /// Most.
    pub max: i64,
}

/// Reasons that go into one answer.
pub const MAX_REASONS: usize = 12;

/// Why a configuration was refused: every field that is out of range.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Reasons {
    /// How many fields are out of range.
    pub count: u8,
    /// The first of them.
    pub first: [Option<OutOfRange>; MAX_REASONS],
}

impl Reasons {
    /// Adds a reason; beyond [`MAX_REASONS`] it is only counted.
    pub fn add(&mut self, reason: OutOfRange) {
        if let Some(free) = self.first.get_mut(usize::from(self.count)) {
            *free = Some(reason);
        }
        self.count = self.count.saturating_add(1);
    }

    /// The reasons that are told in full.
    pub fn iter(&self) -> impl Iterator<Item = &OutOfRange> {
        self.first.iter().flatten()
    }
}

/// The configuration as accepted, with what will serve it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Configured {
    /// CRC-32 of the configuration in its serialised form.
    pub configuration_crc: u32,
    /// The model in use.
    pub model: crate::ModelId,
    /// Samples in the conditioning's window.
    pub window: u16,
}

/// Why an estimator was not made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The bench is outside what can be served; the first field that is.
    OutOfRange(OutOfRange),
    /// The model image on board is damaged or not for this bearing.
    Image {
        /// Position of the cause in the inference crate's list of image errors.
        cause: u8,
    },
}
