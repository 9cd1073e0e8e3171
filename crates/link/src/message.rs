//! Messages in both directions.
//!
//! The order of variants and fields is the wire format. Any change here raises
//! [`crate::PROTOCOL_VERSION`].
//!
//! A [`Command`] carries a number, and its answer carries the same number. The controller executes
//! a command if its number follows the last one's. The same number with the same command gets the
//! same answer again without a second execution. Any other number is refused, and the refusal
//! states the expected number. A host that repeats each command until it is answered therefore
//! agrees with the controller on what was executed, whatever the line loses, repeats or reorders.

use serde::{Deserialize, Serialize};

use crate::authentication::{ManifestHash, Tag};
use crate::start::SupervisorReport;
use crate::track::{SensorHealth, SensorStatus, TrackReport};
use crate::update::{UpdateAnswer, UpdateRequest, UpdateStatus};
use crate::{
    BlockSummary, Configured, ControllerConfiguration, Counters, EstimateLayout, Hello, ImpactRecord,
    NumberedEstimate, Reasons, SamplingReport, SensorFrame, State,
};

/// Message from the host.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ToController {
    /// Requests a [`Hello`]; changes nothing.
    Identify {
        /// Token that the hello frame returns; not 0.
        token: u32,
    },
    /// Requests an action. The answer is [`ToHost::Acknowledged`].
    Command(NumberedCommand),
    /// Carries one sample and the status of its sensors. The answer is [`ToHost::Estimate`] or a
    /// [`Fault`].
    Sensor(SensorFrame, SensorStatus),
    /// Requests information about the models on board, or an update of them. The answer is
    /// [`ToHost::Update`]. These requests are not numbered: each of them may be repeated.
    Update(UpdateRequest),
    /// Requests an action with the tag that a controller with a key requires
    /// ([`crate::authentication`]). Without a key the tag is ignored.
    Authenticated(NumberedCommand, Tag),
}

/// Command with its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct NumberedCommand {
    /// Number of the last command plus 1, modulo 2^32.
    pub id: u32,
    /// Requested action.
    pub command: Command,
}

/// Actions of the controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Command {
    /// Takes a configuration and starts a run. A configuration that is refused changes nothing.
    Configure(ControllerConfiguration),
    /// Returns the configuration.
    GetConfiguration,
    /// Stores the configuration in use, so that it survives a power cut.
    Keep,
    /// Returns the counters.
    GetCounters,
    /// Runs again after a trip.
    ClearTrip,
    /// Ends the run and waits for a configuration.
    Stop,
    /// Continues the run on samples of the controller's own sensors, one per timer tick, until the
    /// run ends. The sample period of the bench must not be shorter than the board's tick.
    SampleYourself,
    /// Returns one of the reports of slow telemetry.
    GetReport(ReportKind),
    /// Permits the update with one package until it is installed or its slot is erased, another one
    /// is permitted, or the controller restarts. A controller without a key needs no permission.
    PermitUpdate(ManifestHash),
}

/// Message from the controller.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ToHost {
    /// Identity of the controller. With token 0 the controller has just started.
    Hello(Hello),
    /// Result of a command.
    Acknowledged(Acknowledgement),
    /// Estimate for one sample.
    Estimate(NumberedEstimate),
    /// Slow telemetry.
    Slow(SlowFrame),
    /// Reason why the last frame was not served.
    Fault(Fault),
    /// Result of a request about models.
    Update(UpdateAnswer),
    /// Impact that has ended. It is sent once; in lockstep, after the estimate of its last sample.
    Impact(ImpactRecord),
    /// Summary of the estimates of own samples up to a sent one. It follows that estimate.
    Block(BlockSummary),
}

/// Result of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Acknowledgement {
    /// Number of the command.
    pub id: u32,
    /// Answer, or the reason of a refusal.
    pub outcome: Result<Answer, Refusal>,
}

/// Answer to a command that was executed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Answer {
    /// Answer to [`Command::Configure`].
    Configured(Configured),
    /// Answer to [`Command::GetConfiguration`]; `None` before the first configuration.
    Configuration(Option<ControllerConfiguration>),
    /// Answer to [`Command::Keep`].
    Kept,
    /// Answer to [`Command::GetCounters`].
    Counters(Counters),
    /// Answer to [`Command::ClearTrip`].
    Cleared,
    /// Answer to [`Command::Stop`]: the counters of the run.
    Stopped(Counters),
    /// Answer to [`Command::SampleYourself`]: only some of the estimates are sent.
    Sampling {
        /// Number of samples from one sent estimate to the next.
        every: u16,
    },
    /// Answer to [`Command::GetReport`].
    Report(SlowReport),
    /// Answer to [`Command::PermitUpdate`].
    UpdatePermitted,
}

/// Reason why a command was not executed, or why no estimator was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Refusal {
    /// The number is neither the next one nor that of the last command.
    OutOfOrder {
        /// Number that would have been executed.
        expected: u32,
    },
    /// The last command had this number and a different content.
    NumberTaken,
    /// Fields of the configuration are out of range.
    Configuration(Reasons),
    /// The model image on board is damaged or made for another bearing.
    Image {
        /// Cause in the inference crate's list of image errors; 100: an image of another bearing.
        cause: u8,
    },
    /// Nothing is configured.
    NotConfigured,
    /// The command is refused during a run.
    Running,
    /// The controller has no storage, or writing failed. With a key of the link, what was to be
    /// stored may be the number of the start.
    NotKept,
    /// The controller has no sensors or no timer that paces samples.
    NoSensors,
    /// The command changes the state and has no valid tag.
    NotAuthenticated,
}

/// Frame of slow telemetry. The reports take turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SlowFrame {
    /// Number of the frame, modulo 2^32.
    pub number: u32,
    /// Sequence number of the last sample.
    pub sequence: u32,
    /// State of the controller.
    pub state: State,
    /// Report of this turn.
    pub report: SlowReport,
}

/// Kinds of reports, in the order of their turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ReportKind {
    /// [`SlowReport::Track`]; only during a run.
    Track,
    /// [`SlowReport::Sensors`]; only during a run.
    Sensors,
    /// [`SlowReport::Counters`].
    Counters,
    /// [`SlowReport::Supervisor`].
    Supervisor,
    /// [`SlowReport::Models`].
    Models,
    /// [`SlowReport::Estimate`]; only during a run.
    Estimate,
    /// [`SlowReport::Sample`]; only from a controller with sensors.
    Sample,
    /// [`SlowReport::Sampling`]; only from a controller whose samples a timer triggers.
    Sampling,
}

impl ReportKind {
    /// All kinds, in order.
    pub const ALL: [Self; 8] = [
        Self::Track,
        Self::Sensors,
        Self::Counters,
        Self::Supervisor,
        Self::Models,
        Self::Estimate,
        Self::Sample,
        Self::Sampling,
    ];
}

/// Report of slow telemetry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SlowReport {
    /// Clearance, friction level, wear, safe state.
    Track(TrackReport),
    /// Faults of the sensors.
    Sensors(SensorHealth),
    /// Counters of the link session.
    Counters(Counters),
    /// Check-ins of the supervised tasks, and the last fault.
    Supervisor(SupervisorReport),
    /// Origin of the networks in use, state of the slots, last package refused.
    Models(UpdateStatus),
    /// Last estimate that was in time, without a number. The layout type is used because it
    /// implements equality.
    Estimate(EstimateLayout),
    /// Last sample of the controller's own sensors, before calibration.
    Sample(SensorFrame),
    /// Timing of the controller's own samples.
    Sampling(SamplingReport),
}

/// Reason why a frame was not served.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Fault {
    /// A sample arrived before any configuration.
    NotConfigured {
        /// Sequence number of the sample.
        sequence: u32,
    },
    /// The frame was damaged.
    BadFrame(crate::FrameError),
}
