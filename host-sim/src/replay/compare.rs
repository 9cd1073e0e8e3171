//! Replays a recorded link session on another controller and compares the answers.
//!
//! Compared to the bit: every estimate, every outcome of a command, the counters of the run,
//! impacts of the same onset, slow telemetry about the same sample. Not compared, because they
//! depend on the transport and not on the run: hellos, durations of ticks, numbers of frames and
//! commands, losses on the line.

use crate::controller::{Controller, ControllerError, Direction, RecordedFrame, Recorder, Recording};
use link::track::SensorStatus;
use link::{
    Acknowledgement, Answer, Command, Counters, Decoder, EstimateFrame, ImpactRecord, NumberedCommand,
    Refusal, SensorFrame, SlowReport, ToController, ToHost,
};
use schemars::JsonSchema;
use serde::{Serialize, de::DeserializeOwned};
use std::collections::BTreeMap;

/// A difference between two link sessions.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Difference {
    /// Sequence number of the sample; none for a difference without one.
    pub sequence: Option<u32>,
    /// Name of the field.
    pub field: String,
    /// Recorded value.
    pub recorded: String,
    /// Replayed value.
    pub replayed: String,
}

/// Result of a replay.
#[derive(Clone, Debug)]
pub struct Replayed {
    /// Samples given to the controller.
    pub samples: usize,
    /// Commands given to it.
    pub commands: usize,
    /// Replayed estimates.
    pub estimates: Vec<EstimateFrame>,
    /// Replayed impacts.
    pub impacts: Vec<ImpactRecord>,
    /// Differences from the recording.
    pub differences: Vec<Difference>,
}

/// A message of the host that is replayed.
enum HostMessage {
    Command(Command),
    Sample(SensorFrame, SensorStatus),
}

/// Sends the recorded messages to a controller and compares the answers.
///
/// # Errors
///
/// A frame of the recording does not belong to this protocol or to a run, or the controller fails.
pub fn replay(recording: &Recording, controller: &mut dyn Controller) -> Result<Replayed, ControllerError> {
    let (messages, commands) = host_messages(&recording.frames)?;
    let recorder = Recorder::default();
    controller.listen(recorder.clone());
    let mut last = None;
    let (mut estimates, mut outcomes) = (Vec::new(), Vec::new());
    for message in &messages {
        match message {
            HostMessage::Command(command) => {
                let outcome = match controller.order(*command) {
                    Ok(answer) => Ok(answer),
                    Err(ControllerError::Refused(refused)) => Err(refused),
                    Err(error) => return Err(error.after(last)),
                };
                outcomes.push((last, describe_outcome(outcome)));
            }
            HostMessage::Sample(frame, status) => {
                estimates.push(controller.sample(frame, *status).map_err(|error| error.after(last))?);
                last = Some(frame.sequence);
            }
        }
    }
    let impacts = controller.take_impacts();
    let recorded = Answers::from_frames(&recording.frames)?;
    // Only the outcomes of the recorded commands: after a lost or late sample the host also asks
    // for the counters, and these commands are not part of the recording.
    let replayed = Answers { outcomes, ..Answers::from_frames(&recorder.take())? };
    let differences = recorded.differences(&replayed);
    Ok(Replayed { samples: messages.len() - commands, commands, estimates, impacts, differences })
}

/// Extracts the host's messages, without repetitions, and the number of commands.
fn host_messages(frames: &[RecordedFrame]) -> Result<(Vec<HostMessage>, usize), ControllerError> {
    let mut messages: Vec<HostMessage> = Vec::new();
    let (mut last_command, mut commands) = (None, 0);
    let mut samples = frames.iter().filter(|f| f.way == Direction::ToController).filter(is_sample).skip(1);
    for frame in frames.iter().filter(|frame| frame.way == Direction::ToController) {
        match message(frame)? {
            ToController::Identify { .. } => {}
            ToController::Command(NumberedCommand { id, .. })
            | ToController::Authenticated(NumberedCommand { id, .. }, _)
                if last_command == Some(id) => {}
            ToController::Command(NumberedCommand { id, command })
            | ToController::Authenticated(NumberedCommand { id, command }, _) => {
                last_command = Some(id);
                commands += 1;
                messages.push(HostMessage::Command(command));
            }
            ToController::Sensor(sample, status) => {
                // Of repeated samples, only the last was received.
                if samples.next().is_none_or(|next| next.bytes != frame.bytes) {
                    messages.push(HostMessage::Sample(sample, status));
                }
            }
            ToController::Update(_) => {
                return Err(unreadable("an update of models".into(), "a link session of a run"));
            }
        }
    }
    Ok((messages, commands))
}

fn is_sample(frame: &&RecordedFrame) -> bool {
    matches!(message(frame), Ok(ToController::Sensor(..)))
}

fn message<M: DeserializeOwned>(frame: &RecordedFrame) -> Result<M, ControllerError> {
    let mut decoder = Decoder::new();
    let mut decoded = frame.bytes.iter().filter_map(|&byte| decoder.push(byte));
    match (decoded.next(), decoded.next()) {
        (Some(Ok(message)), None) => Ok(message),
        (Some(Err(error)), _) => Err(unreadable(error.to_string(), "a frame of this protocol")),
        _ => Err(unreadable(format!("{:02x?}", frame.bytes), "one complete frame")),
    }
}

fn unreadable(found: String, expected: &str) -> ControllerError {
    ControllerError::Unexpected { found: format!("{found} in the recording"), expected: expected.into() }
}

/// Answers of a controller that depend on the run alone.
#[derive(Default)]
struct Answers {
    estimates: Vec<EstimateFrame>,
    outcomes: Vec<(Option<u32>, String)>,
    slow: BTreeMap<(u32, &'static str), String>,
    /// By the sample of the onset.
    impacts: BTreeMap<u32, ImpactRecord>,
}

impl Answers {
    fn from_frames(frames: &[RecordedFrame]) -> Result<Self, ControllerError> {
        let mut answers = Self::default();
        let mut last_id = None;
        for frame in frames.iter().filter(|frame| frame.way == Direction::ToHost) {
            match message(frame)? {
                ToHost::Estimate(numbered) if frame.sequence == Some(numbered.estimate.sequence) => {
                    answers.estimates.push(numbered.estimate);
                }
                ToHost::Acknowledged(Acknowledgement { id, outcome }) if last_id != Some(id) => {
                    last_id = Some(id);
                    answers.outcomes.push((frame.sequence, describe_outcome(outcome)));
                }
                ToHost::Impact(impact) => drop(answers.impacts.insert(impact.onset_sequence, impact)),
                ToHost::Slow(slow) => {
                    let (kind, report) = match slow.report {
                        SlowReport::Track(report) => ("track", format!("{report:?}")),
                        SlowReport::Sensors(health) => ("sensors", format!("{health:?}")),
                        other => {
                            // The other reports do not depend on the run alone, or repeat what is
                            // compared elsewhere.
                            let SlowReport::Counters(counters) = other else { continue };
                            ("counters", format!("{:?}", run_counters(counters)))
                        }
                    };
                    answers.slow.insert((slow.sequence, kind), report);
                }
                _ => {}
            }
        }
        Ok(answers)
    }

    fn differences(&self, now: &Self) -> Vec<Difference> {
        let mut differences = Vec::new();
        let mut differ = |sequence, field: &str, recorded: String, replayed: String| {
            if recorded != replayed {
                differences.push(Difference { sequence, field: field.into(), recorded, replayed });
            }
        };
        for (a, b) in self.estimates.iter().zip(&now.estimates) {
            if !a.same_bits(b) {
                for ((field, a_value), (_, b_value)) in fields(a).into_iter().zip(fields(b)) {
                    differ(Some(a.sequence), field, a_value, b_value);
                }
            }
        }
        for ((sequence, a), (_, b)) in self.outcomes.iter().zip(&now.outcomes) {
            differ(*sequence, "outcome of a command", a.clone(), b.clone());
        }
        let count = |list: usize| list.to_string();
        differ(None, "number of estimates", count(self.estimates.len()), count(now.estimates.len()));
        differ(None, "number of outcomes", count(self.outcomes.len()), count(now.outcomes.len()));
        for (sequence, a) in &self.impacts {
            // A record that one of the lines lost is still in the counters.
            if let Some(b) = now.impacts.get(sequence) {
                differ(Some(*sequence), "impact", format!("{a:?}"), format!("{b:?}"));
            }
        }
        for ((sequence, kind), a) in &self.slow {
            // The order of the reports continues from run to run. Where the other controller sent
            // another report, there is nothing to compare.
            if let Some(b) = now.slow.get(&(*sequence, kind)) {
                differ(Some(*sequence), &format!("slow telemetry, {kind}"), a.clone(), b.clone());
            }
        }
        differences
    }
}

/// Formats the outcome of a command without the counts that depend on the line.
fn describe_outcome(outcome: Result<Answer, Refusal>) -> String {
    let outcome = outcome.map(|answer| match answer {
        Answer::Counters(counters) => Answer::Counters(run_counters(counters)),
        Answer::Stopped(counters) => Answer::Stopped(run_counters(counters)),
        other => other,
    });
    format!("{outcome:?}")
}

/// Keeps the counters that depend on the run alone, not on the line or on waiting.
fn run_counters(counters: Counters) -> Counters {
    let Counters {
        samples,
        flagged,
        sequence_gaps,
        time_faults,
        over_force,
        deadline_overruns,
        trips,
        held,
        impacts,
        ..
    } = counters;
    Counters {
        samples,
        flagged,
        sequence_gaps,
        time_faults,
        over_force,
        deadline_overruns,
        trips,
        held,
        impacts,
        ..Counters::default()
    }
}

/// Fields of an estimate as text that shows every bit.
fn fields(e: &EstimateFrame) -> [(&'static str, String); 10] {
    let float = |value: f32| format!("{value:e} ({:08x})", value.to_bits());
    [
        ("sequence", e.sequence.to_string()),
        ("time_us", e.time_us.to_string()),
        ("normal_force_n", float(e.normal_force_n)),
        ("force_y_n", float(e.force_y_n)),
        ("force_z_n", float(e.force_z_n)),
        ("friction_torque_nm", float(e.friction_torque_nm)),
        ("deformation_m", float(e.deformation_m)),
        ("contact_angle_rad", float(e.contact_angle_rad)),
        ("flags", format!("{:08x}", e.flags)),
        ("saturated", e.saturated.to_string()),
    ]
}
