//! The messages: what goes in a frame either way.
//!
//! The order of variants and fields is the wire format: any change here raises [`crate::PROTOCOL_VERSION`].
//!
//! A [`Command`] carries a number and is answered with it. The controller carries a command out if its number follows the last one's; the
//! same number with the same command is answered again without being carried out again; any other number is refused with the one
//! that was expected. A host that repeats a command until it is answered, and only then goes on, therefore ends
//! where the controller is, whatever the line loses, repeats or reorders.

use serde::{Deserialize, Serialize};

use crate::start::SupervisorReport;
use crate::track::{SensorHealth, SensorStatus, TrackReport};
use crate::update::{UpdateAnswer, UpdateRequest, UpdateStatus};
use crate::{
    Configured, ControllerConfiguration, Counters, EstimateLayout, Hello, NumberedEstimate, Reasons,
    SensorFrame,
};

/// What the host sends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ToController {
    /// Asks for a [`Hello`], changes nothing.
    Identify {
        /// Comes back in the greeting; not 0.
        token: u32,
    },
    /// Wants something done; the answer is [`ToHost::Acknowledged`].
    Command(NumberedCommand),
    /// One sample and what the drivers say about it; the answer is [`ToHost::Estimate`] or a [`Fault`].
    Sensor(SensorFrame, SensorStatus),
    /// Asks about the models kept on board, or for an update of them; the answer is [`ToHost::Update`]. Not numbered: every such request
    /// may be repeated.
    Update(UpdateRequest),
}

/// A command with its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct NumberedCommand {
    /// One more than the last command's, modulo 2^32.
    pub id: u32,
    /// What to do.
    pub command: Command,
}

/// What the controller can be told to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Command {
    /// Take a configuration and run with it. Checked as a whole: refused, it changes nothing.
    Configure(ControllerConfiguration),
    /// Say what the configuration is.
    GetConfiguration,
    /// Keep the configuration in use over a power cut.
    Keep,
    /// Say what was counted.
    GetCounters,
    /// Run again after a trip.
    ClearTrip,
    /// End the run and wait to be configured again.
    Stop,
    /// Go on with the run on samples of the controller's own sensors, one every timer tick, until it ends. The bench's sample period is 100 us then.
    SampleYourself,
    /// Give one of the reports of slow telemetry now.
    GetReport(ReportKind),
}

/// What the controller sends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ToHost {
    /// Who is speaking. With token 0 it means that the controller has just started.
    Hello(Hello),
    /// What became of a command.
    Acknowledged(Acknowledgement),
    /// The estimate for one sample.
    Estimate(NumberedEstimate),
    /// Slow telemetry.
    Slow(SlowFrame),
    /// The last frame could not be served.
    Fault(Fault),
    /// What became of a request about models.
    Update(UpdateAnswer),
}

/// What became of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Acknowledgement {
    /// The command's number.
    pub id: u32,
    /// Carried out, or why not.
    pub outcome: Result<Answer, Refused>,
}

/// The answer to a command that was carried out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Answer {
    /// To [`Command::Configure`].
    Configured(Configured),
    /// To [`Command::GetConfiguration`]; none before there is one.
    Configuration(Option<ControllerConfiguration>),
    /// To [`Command::Keep`].
    Kept,
    /// To [`Command::GetCounters`].
    Counters(Counters),
    /// To [`Command::ClearTrip`].
    Cleared,
    /// To [`Command::Stop`]: what the run counted.
    Stopped(Counters),
    /// To [`Command::SampleYourself`]: one estimate in so many is sent.
    Sampling {
        /// Samples from one sent estimate to the next.
        every: u16,
    },
    /// To [`Command::GetReport`].
    Report(SlowReport),
}

/// Why a command was not carried out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Refused {
    /// The number is neither the next one nor the last one's.
    OutOfOrder {
        /// The number that would have been carried out.
        expected: u32,
    },
    /// The last command had this number and was another one.
    NumberTaken,
    /// Fields of the configuration are out of range.
    Configuration(Reasons),
    /// The model image on board is damaged or not for this bearing.
    Image {
        /// Position of the cause in the inference crate's list of image errors.
        cause: u8,
    },
    /// Nothing is configured.
    NotConfigured,
    /// Only served while no run is on.
    Running,
    /// The controller has nowhere to keep it, or it could not be written.
    NotKept,
    /// The controller has no sensors of its own, or no timer that paces it.
    NoSensors,
}

/// What the controller is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum State {
    /// Waiting to be configured.
    #[default]
    Waiting,
    /// Estimating.
    Running,
    /// Too many late estimates: the last good one is held until [`Command::ClearTrip`].
    Tripped,
}

/// A frame of slow telemetry. The reports take turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SlowFrame {
    /// Counts up by one a frame of slow telemetry, modulo 2^32.
    pub number: u32,
    /// Sequence number of the last sample.
    pub sequence: u32,
    /// What the controller is doing.
    pub state: State,
    /// The report whose turn it is.
    pub report: SlowReport,
}

/// The reports of slow telemetry, in the order of their turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ReportKind {
    /// [`SlowReport::Track`]; of a run.
    Track,
    /// [`SlowReport::Sensors`]; of a run.
    Sensors,
    /// [`SlowReport::Counters`].
    Counters,
    /// [`SlowReport::Supervisor`].
    Supervisor,
    /// [`SlowReport::Models`].
    Models,
    /// [`SlowReport::Estimate`]; of a run.
    Estimate,
    /// [`SlowReport::Sample`]; of a controller with sensors.
    Sample,
}

impl ReportKind {
    /// Every report, in order.
    pub const ALL: [Self; 7] = [
        Self::Track,
        Self::Sensors,
        Self::Counters,
        Self::Supervisor,
        Self::Models,
        Self::Estimate,
        Self::Sample,
    ];
}

/// A report of slow telemetry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SlowReport {
    /// Clearance, friction level, wear, safe state.
    Track(TrackReport),
    /// What was wrong with the sensors.
    Sensors(SensorHealth),
    /// What the session counted.
    Counters(Counters),
    /// Who has checked in, and the last fault.
    Supervisor(SupervisorReport),
    /// Where the networks come from, the slots, the last package refused.
    Models(UpdateStatus),
    /// The last estimate that was in time, without a number: a [`NumberedEstimate`] in the form that has an equality.
    Estimate(EstimateLayout),
    /// The last sample of the controller's own sensors, as it is before calibration.
    Sample(SensorFrame),
}

/// Why a frame was not served.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Fault {
    /// A sample came before any configuration.
    NotConfigured {
        /// Sequence number of the sample.
        sequence: u32,
    },
    /// The frame was damaged.
    BadFrame(crate::FrameError),
}
