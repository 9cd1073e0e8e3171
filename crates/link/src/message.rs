//! The messages, their units and ranges.
//!
//! The order of variants and fields is the wire format: any change here raises [`PROTOCOL_VERSION`].

use serde::{Deserialize, Serialize};

/// First bytes of a [`Hello`], so that a foreign device on the same port is recognised as foreign.
pub const MAGIC: [u8; 4] = *b"PNTL";

/// Version of the messages. Host and controller must agree; the host refuses any other.
pub const PROTOCOL_VERSION: u8 = 1;

/// Room for the build's name in a [`Hello`].
pub const BUILD_ID_LEN: usize = 32;

/// Name of a build (`git describe`, or the crate's version), padded with zeros.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BuildId(pub [u8; BUILD_ID_LEN]);

impl BuildId {
    /// Takes the first [`BUILD_ID_LEN`] bytes of a name.
    #[must_use]
    pub fn new(name: &str) -> Self {
        let mut bytes = [0; BUILD_ID_LEN];
        for (to, from) in bytes.iter_mut().zip(name.bytes()) {
            *to = from;
        }
        Self(bytes)
    }

    /// The name as text; empty when the bytes are not UTF-8.
    #[must_use]
    pub fn as_str(&self) -> &str {
        let end = self.0.iter().position(|&b| b == 0).unwrap_or(BUILD_ID_LEN);
        self.0.get(..end).and_then(|name| core::str::from_utf8(name).ok()).unwrap_or_default()
    }
}

/// What the host sends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ToController {
    /// Asks for a [`Hello`]. The controller also sends one by itself when it starts.
    Identify,
    /// Sets the bench up; the answer is [`ToHost::Configured`] or a [`Fault`]. Resets the estimator.
    Configure(Configuration),
    /// One sample; the answer is [`ToHost::Estimate`] or a [`Fault`].
    Sensor(SensorFrame),
    /// Ends the run; the answer is [`ToHost::Stopped`]. The controller then waits to be configured again.
    Stop,
}

/// What the controller sends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ToHost {
    /// Who is speaking. Unasked for, it means that the controller has restarted.
    Hello(Hello),
    /// The configuration was accepted.
    Configured(Configured),
    /// The estimate for one sample.
    Estimate(EstimateFrame),
    /// The run is over.
    Stopped(Counters),
    /// The last message could not be served.
    Fault(Fault),
}

/// Where the controller runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Target {
    /// In the host's own process.
    Native,
    /// On the emulator.
    Emulator,
    /// On a microcontroller.
    Silicon,
}

/// What drives the controller's core after start-up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ClockSource {
    /// The host's clock; nothing was brought up.
    Host,
    /// PLL on the crystal.
    PllCrystal,
    /// PLL on the internal oscillator.
    PllInternal,
    /// The crystal without PLL.
    Crystal,
    /// The internal oscillator: all else failed, or is not there (the emulator).
    Internal,
}

/// Identifies one model image on board.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ModelId {
    /// CRC-32 of the image; 0 when the image was refused at start-up.
    pub crc: u32,
    /// Identifier of the training run that made it; 0 when the image was refused.
    pub training_id: u64,
}

/// Who the controller is and what it carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Hello {
    /// [`MAGIC`].
    pub magic: [u8; 4],
    /// [`PROTOCOL_VERSION`].
    pub protocol: u8,
    /// Name of the firmware's build.
    pub build_id: BuildId,
    /// Where it runs.
    pub target: Target,
    /// Clock that start-up arrived at.
    pub clock: ClockSource,
    /// Core frequency, Hz.
    pub core_hz: u32,
    /// Samples in the conditioning's window.
    pub window: u16,
    /// Model images by bearing code.
    pub models: [ModelId; 2],
}

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

/// The configuration as accepted, with what will serve it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Configured {
    /// The configuration.
    pub configuration: Configuration,
    /// The model in use.
    pub model: ModelId,
    /// Samples in the conditioning's window.
    pub window: u16,
}

/// One sample of the sensors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SensorFrame {
    /// Counts up by one a sample, modulo 2^32.
    pub sequence: u32,
    /// Time of the sample, us, modulo 2^32.
    pub time_us: u32,
    /// Journal centre from the bearing's centre along y, nm.
    pub journal_y_nm: i32,
    /// Journal centre from the bearing's centre along z (up), nm.
    pub journal_z_nm: i32,
    /// Shaft angle, nrad, modulo 2^32: only its differences are used.
    pub shaft_angle_nrad: i32,
    /// Load force along y, mN; carried for the log, not used by the estimator.
    pub load_force_mn: i32,
}

/// The estimate for one sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EstimateFrame {
    /// Sequence number of the sample.
    pub sequence: u32,
    /// Time of the sample, us.
    pub time_us: u32,
    /// Normal contact force, N, not negative.
    pub normal_force_n: f32,
    /// Force of the bearing on the journal along y, N: normal and friction together.
    pub force_y_n: f32,
    /// Force of the bearing on the journal along z, N.
    pub force_z_n: f32,
    /// Torque of the bearing on the shaft, N m: `F_f R_J`, negative while the shaft slides forward.
    pub friction_torque_nm: f32,
    /// Deformation, m; negative is the gap.
    pub deformation_m: f32,
    /// Direction of the journal from the bearing's centre, rad, from +y towards +z.
    pub contact_angle_rad: f32,
    /// Flags of the networks (bits 0 to 15) and of the sensors (bits 16 to 31).
    pub flags: u32,
    /// Activations that saturated in this sample.
    pub saturated: u16,
    /// Timer ticks that the estimator took; natively 0. Not part of the result.
    pub instruction_ticks: u32,
}

impl EstimateFrame {
    /// Whether two estimates agree in every bit of every field but the tick count.
    #[must_use]
    pub fn same_bits(&self, other: &Self) -> bool {
        self.bits() == other.bits()
    }

    fn bits(&self) -> [u32; 10] {
        [
            self.sequence,
            self.time_us,
            self.normal_force_n.to_bits(),
            self.force_y_n.to_bits(),
            self.force_z_n.to_bits(),
            self.friction_torque_nm.to_bits(),
            self.deformation_m.to_bits(),
            self.contact_angle_rad.to_bits(),
            self.flags,
            u32::from(self.saturated),
        ]
    }
}

/// What the controller counted since it was configured (frame errors: since it started).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    /// Samples served.
    pub samples: u32,
    /// Samples whose estimate carried a sensor flag.
    pub flagged: u32,
    /// Samples whose sequence number did not follow.
    pub sequence_gaps: u32,
    /// Samples whose time did not advance by the sample period.
    pub time_faults: u32,
    /// Ticks that ran into the next one (silicon), or took longer than the sample period.
    pub deadline_overruns: u32,
    /// Timer ticks that found no sample waiting (silicon).
    pub idle_ticks: u32,
    /// Samples dropped because the queue was full (silicon).
    pub dropped: u32,
    /// Frames that were refused.
    pub bad_frames: crate::BadFrames,
}

/// Why a message was not served.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Fault {
    /// A sample came before any configuration.
    NotConfigured {
        /// Sequence number of the sample.
        sequence: u32,
    },
    /// The configuration was not accepted.
    Refused(Refusal),
    /// The frame was damaged.
    BadFrame(crate::FrameError),
}

/// Why a configuration was not accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Refusal {
    /// No bearing has this code.
    UnknownBearing {
        /// The code found.
        found: u8,
    },
    /// The clearance is outside what can be served.
    RadialClearance {
        /// Found, nm.
        found_nm: u32,
        /// Least, nm.
        min_nm: u32,
        /// Most, nm.
        max_nm: u32,
    },
    /// The journal radius is outside what can be served.
    JournalRadius {
        /// Found, nm.
        found_nm: u32,
        /// Least, nm.
        min_nm: u32,
        /// Most, nm.
        max_nm: u32,
    },
    /// The sample period is not the one that the conditioning and the networks were made for.
    SamplePeriod {
        /// Found, us.
        found_us: u32,
        /// Least, us.
        min_us: u32,
        /// Most, us.
        max_us: u32,
    },
    /// The latch floor is outside what can be served.
    LatchFloor {
        /// Found, um/s.
        found_um_s: u32,
        /// Least, um/s.
        min_um_s: u32,
        /// Most, um/s.
        max_um_s: u32,
    },
    /// The approach speed assumed for an unseen onset is outside what can be served.
    UnseenApproach {
        /// Found, um/s.
        found_um_s: u32,
        /// Least, um/s.
        min_um_s: u32,
        /// Most, um/s.
        max_um_s: u32,
    },
    /// The model image on board is damaged or not for this bearing.
    Image {
        /// Position of the cause in the inference crate's list of image errors.
        cause: u8,
    },
}
