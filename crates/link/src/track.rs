//! Slow telemetry about bearing and sensors, and the configuration that the monitor requires for
//! it.
//!
//! All fields are integers of fixed size with SI multiples in their names. A [`TrackReport`]
//! carries the tracked quantities, a [`SensorHealth`] the sensor faults since the last
//! configuration. Each fits into one frame and is sent a few times a second. [`SensorStatus`]
//! accompanies every [`crate::SensorFrame`]. [`MonitorConfiguration`] is a part of the bench
//! description. The accepted ranges are those of `controller::monitor`, which names the refused
//! [`MonitorField`].

use serde::{Deserialize, Serialize};

/// Channels of a sensor frame, in the order of all per-channel lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SensorChannel {
    /// Journal centre along y.
    JournalY,
    /// Journal centre along z.
    JournalZ,
    /// Shaft angle.
    ShaftAngle,
    /// Load force.
    LoadForce,
}

/// Number of [`SensorChannel`]s.
pub const CHANNELS: usize = 4;

impl SensorChannel {
    /// All channels, in order.
    pub const ALL: [Self; CHANNELS] = [Self::JournalY, Self::JournalZ, Self::ShaftAngle, Self::LoadForce];

    /// Returns the lower-case name for reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::JournalY => "journal-y",
            Self::JournalZ => "journal-z",
            Self::ShaftAngle => "shaft-angle",
            Self::LoadForce => "load-force",
        }
    }
}

/// Status of the channels of one sample: bits 0 to 3 missing, bits 4 to 7 at the rail, by channel.
///
/// A channel is missing if its transaction failed, timed out, had a parity or error flag, or its
/// wire is broken. Its value in the frame is then the last good one. A channel at the rail shows
/// the end of the converter's or transmitter's range.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SensorStatus(pub u8);

impl SensorStatus {
    /// No channel missing or at its rail.
    pub const GOOD: Self = Self(0);

    /// Returns this status with one channel marked as missing.
    #[must_use]
    pub const fn missing(self, channel: SensorChannel) -> Self {
        Self(self.0 | 1 << channel as u8)
    }

    /// Returns this status with one channel marked as at its rail.
    #[must_use]
    pub const fn at_rail(self, channel: SensorChannel) -> Self {
        Self(self.0 | 0x10 << channel as u8)
    }

    /// Returns one bit per missing channel.
    #[must_use]
    pub const fn missing_bits(self) -> u8 {
        self.0 & 0x0f
    }

    /// Returns one bit per channel at its rail.
    #[must_use]
    pub const fn rail_bits(self) -> u8 {
        self.0 >> 4
    }
}

/// Number of samples with each fault of one channel, saturating.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ChannelCounts {
    /// The driver had no value.
    pub missing: u32,
    /// The value was at the end of the range.
    pub saturated: u32,
    /// The value did not change for the stuck time.
    pub stuck: u32,
    /// The short-term deviation was above the configured limit.
    pub noisy: u32,
    /// The value moved further than the machine can.
    pub jumped: u32,
}

/// Sensor faults since the last configuration, in samples, saturating.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SensorHealth {
    /// Time of the report's last sample, us.
    pub time_us: u32,
    /// Counts by [`SensorChannel`].
    pub channels: [ChannelCounts; CHANNELS],
    /// Samples with a sequence number out of order.
    pub sequence_gaps: u32,
    /// Samples whose time did not advance by the period.
    pub time_faults: u32,
    /// Samples with the journal farther out than clearance and largest deformation allow.
    pub implausible_positions: u32,
    /// Samples with the journal moving along the clearance faster than possible.
    pub implausible_swings: u32,
    /// Estimates outside the envelope of the analytic law.
    pub outside_law: u32,
    /// Samples whose estimate was held.
    pub held: u32,
    /// Number of times that holding began.
    pub holds: u32,
}

/// State of trust in the estimates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum SafeState {
    /// No estimate has been trusted since the configuration.
    #[default]
    Starting,
    /// The estimates are live.
    Live,
    /// A fault is present or has ended too recently: the last trusted estimate is repeated.
    Held,
    /// Held for so long that the repeated estimate has no meaning: its forces are 0.
    Lost,
}

/// State of the wear alarm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Wear {
    /// Not enough evidence yet.
    #[default]
    Unknown,
    /// Below the limit.
    Below,
    /// Above the limit with the stated confidence, and not yet back below the hysteresis.
    Alarm,
}

/// State of the friction alarm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum FrictionState {
    /// No limit is configured.
    #[default]
    NoLimit,
    /// Not enough evidence yet.
    Unknown,
    /// Below the limit.
    Below,
    /// Above the limit with the stated confidence, and not yet back below the hysteresis.
    Alarm,
}

/// Tracked quantities.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TrackReport {
    /// Time of the report's last sample, us.
    pub time_us: u32,
    /// Radial clearance, nm.
    pub radial_clearance_nm: u32,
    /// One standard deviation of the clearance, nm; `u32::MAX` before there is evidence.
    pub radial_clearance_deviation_nm: u32,
    /// Friction over the described one, thousandths.
    pub friction_level_per_mille: u32,
    /// One standard deviation of the friction level, thousandths; `u32::MAX` before there is
    /// evidence.
    pub friction_level_deviation_per_mille: u32,
    /// Stiffness of the contact over the described one, thousandths.
    pub stiffness_per_mille: u32,
    /// One standard deviation of the stiffness, thousandths; `u32::MAX` before there is evidence.
    pub stiffness_deviation_per_mille: u32,
    /// Wear alarm.
    pub wear: Wear,
    /// Number of wear alarms, saturating.
    pub wear_alarms: u32,
    /// Friction alarm.
    pub friction: FrictionState,
    /// Number of friction alarms, saturating.
    pub friction_alarms: u32,
    /// Safe state.
    pub safe_state: SafeState,
}

/// Properties of a bench that the monitor requires.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MonitorConfiguration {
    /// Mass of the shaft, g.
    pub mass_g: u32,
    /// Moment of inertia of the shaft and all parts that turn with it, g m2.
    pub inertia_g_m2: u32,
    /// Radius of the drive crank, um.
    pub drive_lever_um: u32,
    /// Radius of the load crank, um.
    pub load_lever_um: u32,
    /// Shaft angle reading with the drive crank vertical, nrad.
    pub crank_vertical_nrad: i32,
    /// Effective modulus of bearing and journal, kPa: `1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2`.
    pub effective_modulus_kpa: u32,
    /// Dissipation factor `chi(e)` of the contact law, thousandths; 0: that of the bearing's
    /// material.
    pub damping_per_mille: u16,
    /// One standard deviation of the contact's stiffness, thousandths of it.
    pub stiffness_deviation_per_mille: u16,
    /// One standard deviation of the moment of inertia, thousandths of it.
    pub inertia_deviation_per_mille: u16,
    /// One standard deviation of the mass, thousandths of it.
    pub mass_deviation_per_mille: u16,
    /// One standard deviation of either lever's radius, hundred-thousandths of it.
    pub lever_deviation_ppht: u16,
    /// One standard deviation of the radial clearance, nm.
    pub clearance_deviation_nm: u32,
    /// One standard deviation of the friction level, thousandths of it.
    pub friction_deviation_per_mille: u16,
    /// Friction over that of the bearing's material, thousandths.
    pub friction_level_per_mille: u16,
    /// Stroke of the drive, mm.
    pub stroke_mm: u16,
    /// Period of the drive's motion, ms.
    pub drive_period_ms: u16,
    /// Standard deviation of a journal coordinate's noise, nm.
    pub journal_noise_nm: u16,
    /// Standard deviation of the shaft angle's noise, nrad.
    pub angle_noise_nrad: u32,
    /// Largest short-term standard deviation of a journal coordinate, nm.
    pub journal_noise_limit_nm: u32,
    /// Largest short-term standard deviation of the shaft angle, nrad.
    pub angle_noise_limit_nrad: u32,
    /// Largest short-term standard deviation of the load, mN.
    pub load_noise_limit_mn: u32,
    /// Number of equal load codes after which the load counts as stuck. With 0 it never does,
    /// because a steady load read by a coarse converter can stay constant.
    pub load_stuck_samples: u16,
    /// Magnitude at and above which a journal coordinate counts as at its rail, nm.
    pub journal_rail_nm: u32,
    /// Magnitude at and above which the load counts as at its rail, mN.
    pub load_rail_mn: u32,
    /// Half width of the analytic law's envelope, thousandths of the law's force.
    pub envelope_per_mille: u16,
    /// Half width of the envelope at zero force, N.
    pub envelope_floor_n: u16,
    /// Number of samples without a fault after which a held estimate is live again.
    pub recovery_samples: u16,
    /// Number of held samples after which the estimate is lost.
    pub lost_samples: u32,
    /// Radial clearance at which the wear alarm is raised, nm.
    pub wear_limit_nm: u32,
    /// Distance below the limit at which the alarm ends, nm.
    pub wear_hysteresis_nm: u32,
}

/// Field of a [`MonitorConfiguration`] that was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum MonitorField {
    /// `mass_g`.
    Mass,
    /// `inertia_g_m2`.
    Inertia,
    /// `drive_lever_um`.
    DriveLever,
    /// `load_lever_um`.
    LoadLever,
    /// `effective_modulus_kpa`.
    EffectiveModulus,
    /// `damping_per_mille`.
    Damping,
    /// `stiffness_deviation_per_mille`.
    StiffnessDeviation,
    /// `inertia_deviation_per_mille`.
    InertiaDeviation,
    /// `mass_deviation_per_mille`.
    MassDeviation,
    /// `lever_deviation_ppht`.
    LeverDeviation,
    /// `clearance_deviation_nm`.
    ClearanceDeviation,
    /// `friction_deviation_per_mille`.
    FrictionDeviation,
    /// `friction_level_per_mille`.
    FrictionLevel,
    /// `stroke_mm`.
    Stroke,
    /// `drive_period_ms`.
    DrivePeriod,
    /// `journal_noise_nm`.
    JournalNoise,
    /// `angle_noise_nrad`.
    AngleNoise,
    /// `journal_noise_limit_nm`.
    JournalNoiseLimit,
    /// `angle_noise_limit_nrad`.
    AngleNoiseLimit,
    /// `load_noise_limit_mn`.
    LoadNoiseLimit,
    /// `load_stuck_samples`.
    LoadStuckSamples,
    /// `journal_rail_nm`.
    JournalRail,
    /// `load_rail_mn`.
    LoadRail,
    /// `envelope_per_mille`.
    EnvelopeShare,
    /// `envelope_floor_n`.
    EnvelopeFloor,
    /// `recovery_samples`.
    RecoverySamples,
    /// `lost_samples`.
    LostSamples,
    /// `wear_limit_nm`.
    WearLimit,
    /// `wear_hysteresis_nm`.
    WearHysteresis,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_channel_has_separate_bits_for_missing_and_for_rail() {
        for (channel, bit) in SensorChannel::ALL.into_iter().zip(0..) {
            assert_eq!(SensorStatus::GOOD.missing(channel).missing_bits(), 1 << bit);
            assert_eq!(SensorStatus::GOOD.missing(channel).rail_bits(), 0);
            assert_eq!(SensorStatus::GOOD.at_rail(channel).rail_bits(), 1 << bit);
        }
    }

    #[test]
    fn the_longest_reports_fit_into_a_frame() {
        let counts = ChannelCounts {
            missing: u32::MAX,
            saturated: u32::MAX,
            stuck: u32::MAX,
            noisy: u32::MAX,
            jumped: u32::MAX,
        };
        let health = SensorHealth {
            time_us: u32::MAX,
            channels: [counts; CHANNELS],
            sequence_gaps: u32::MAX,
            time_faults: u32::MAX,
            implausible_positions: u32::MAX,
            implausible_swings: u32::MAX,
            outside_law: u32::MAX,
            held: u32::MAX,
            holds: u32::MAX,
        };
        // The frame also holds four bytes of CRC and one for the message's kind.
        let mut room = [0; crate::MAX_PAYLOAD - 5];
        assert!(postcard::to_slice(&health, &mut room).is_ok());
    }
}
