//! A recorded conversation once more: what the host said to whatever controller there is now, and what that says otherwise.
//!
//! Compared to the bit: every estimate, every outcome of a command, the counts of the run, slow telemetry about the same sample. Not compared,
//! because they belong to the end and not to the run: greetings, the durations of ticks, numbers of frames and commands, what was lost on the line.

use super::{Controller, ControllerError, RecordedFrame, Recorder, Recording, Way};
use link::track::SensorStatus;
use link::{
    Acknowledgement, Answer, Command, Counters, Decoder, EstimateFrame, NumberedCommand, SensorFrame,
    SlowReport, ToController, ToHost,
};
use serde::{Serialize, de::DeserializeOwned};
use std::collections::BTreeMap;

/// A difference between two conversations.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Difference {
    /// The sample; none for what belongs to none.
    pub sequence: Option<u32>,
    /// What differs.
    pub field: String,
    /// What was recorded.
    pub recorded: String,
    /// What came now.
    pub replayed: String,
}

/// What a replay found.
#[derive(Clone, Debug)]
pub struct Replayed {
    /// Samples given to the controller.
    pub samples: usize,
    /// Commands given to it.
    pub commands: usize,
    /// Estimates as they came now.
    pub estimates: Vec<EstimateFrame>,
    /// What differs from the recording.
    pub differences: Vec<Difference>,
}

/// What of a host's frames is said again.
enum Said {
    Command(Command),
    Sample(SensorFrame, SensorStatus),
}

/// Says everything again and compares the answers.
///
/// # Errors
///
/// A frame of the recording is none of this protocol or not one of a run, or the controller fails.
pub fn replay(recording: &Recording, controller: &mut dyn Controller) -> Result<Replayed, ControllerError> {
    let (said, commands) = said(&recording.frames)?;
    let recorder = Recorder::default();
    controller.listen(recorder.clone());
    let mut last = None;
    let mut estimates = Vec::new();
    for said in &said {
        match said {
            Said::Command(command) => match controller.order(*command) {
                Ok(_) | Err(ControllerError::Refused(_)) => {}
                Err(error) => return Err(error.after(last)),
            },
            Said::Sample(frame, status) => {
                estimates.push(controller.sample(frame, *status).map_err(|error| error.after(last))?);
                last = Some(frame.sequence);
            }
        }
    }
    let recorded = Answers::of(&recording.frames)?;
    let differences = recorded.differences(&Answers::of(&recorder.take())?);
    Ok(Replayed { samples: said.len() - commands, commands, estimates, differences })
}

/// What the host said, once each: what it repeated because of the line is left out. With the number of commands.
fn said(frames: &[RecordedFrame]) -> Result<(Vec<Said>, usize), ControllerError> {
    let mut said: Vec<Said> = Vec::new();
    let (mut last_command, mut commands) = (None, 0);
    let mut samples = frames.iter().filter(|f| f.way == Way::ToController).filter(is_sample).skip(1);
    for frame in frames.iter().filter(|frame| frame.way == Way::ToController) {
        match message(frame)? {
            ToController::Identify { .. } => {}
            ToController::Command(NumberedCommand { id, .. }) if last_command == Some(id) => {}
            ToController::Command(NumberedCommand { id, command }) => {
                last_command = Some(id);
                commands += 1;
                said.push(Said::Command(command));
            }
            ToController::Sensor(sample, status) => {
                // Sent again: only the last one was taken.
                if samples.next().is_none_or(|next| next.bytes != frame.bytes) {
                    said.push(Said::Sample(sample, status));
                }
            }
            ToController::Update(_) => {
                return Err(unreadable("an update of models".into(), "a conversation of a run"));
            }
        }
    }
    Ok((said, commands))
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
        _ => Err(unreadable(format!("{:02x?}", frame.bytes), "one whole frame")),
    }
}

fn unreadable(found: String, expected: &str) -> ControllerError {
    ControllerError::Unexpected { found: format!("{found} in the recording"), expected: expected.into() }
}

/// What a controller answered, as far as it belongs to the run.
#[derive(Default)]
struct Answers {
    estimates: Vec<EstimateFrame>,
    outcomes: Vec<(Option<u32>, String)>,
    slow: BTreeMap<(u32, &'static str), String>,
}

impl Answers {
    fn of(frames: &[RecordedFrame]) -> Result<Self, ControllerError> {
        let mut answers = Self::default();
        let mut last_id = None;
        for frame in frames.iter().filter(|frame| frame.way == Way::ToHost) {
            match message(frame)? {
                ToHost::Estimate(numbered) if frame.sequence == Some(numbered.estimate.sequence) => {
                    answers.estimates.push(numbered.estimate);
                }
                ToHost::Acknowledged(Acknowledgement { id, outcome }) if last_id != Some(id) => {
                    last_id = Some(id);
                    let outcome = outcome.map(|answer| match answer {
                        Answer::Counters(counters) => Answer::Counters(of_the_run(counters)),
                        Answer::Stopped(counters) => Answer::Stopped(of_the_run(counters)),
                        other => other,
                    });
                    answers.outcomes.push((frame.sequence, format!("{outcome:?}")));
                }
                ToHost::Slow(slow) => {
                    let (kind, report) = match slow.report {
                        SlowReport::Track(report) => ("track", format!("{report:?}")),
                        SlowReport::Sensors(health) => ("sensors", format!("{health:?}")),
                        other => {
                            // Others are not of the run alone, or tell again what has been compared.
                            let SlowReport::Counters(counters) = other else { continue };
                            ("counters", format!("{:?}", of_the_run(counters)))
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
        for ((sequence, kind), a) in &self.slow {
            // Whose turn it is goes on from run to run; where it is another report's there is nothing to compare.
            if let Some(b) = now.slow.get(&(*sequence, kind)) {
                differ(Some(*sequence), &format!("slow telemetry, {kind}"), a.clone(), b.clone());
            }
        }
        differences
    }
}

/// The counts that tell of the run; the others tell of the line and of waiting.
fn of_the_run(counters: Counters) -> Counters {
    let Counters {
        samples,
        flagged,
        sequence_gaps,
        time_faults,
        over_force,
        deadline_overruns,
        trips,
        held,
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
        ..Counters::default()
    }
}

/// Everything that belongs to an estimate's result, as text that tells every bit.
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
