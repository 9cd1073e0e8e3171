//! Class of a fault: what the host receives about it, compared with the error of the unmarked
//! estimates.
//!
//! * **Detected**: the host gets a report before or with the first wrong estimate, and no unmarked
//!   estimate is wrong afterwards.
//! * **Wrong again**: as detected, but unmarked estimates are wrong after the mark has ended: a
//!   mark lasts only as long as the check fails.
//! * **Detected late**: unmarked estimates were wrong before the first report. The latency counts
//!   from the first wrong one.
//! * **Harmless**: no report, and no estimate is wrong.
//! * **Silent**: no report, and estimates are wrong.
//! * **Not struck**: the core never reached the instruction of the fault, so nothing was disturbed.
//!
//! An estimate is **wrong** if it is unmarked and off by more than [`BOUND_SHARE`] of full scale in
//! a force, the torque or the deformation. Full scale is the largest value of the run without
//! fault. In contact the angle counts, too, relative to half a turn. An estimate that is not a
//! number is wrong. The flag `over-force` is not a mark.
//!
//! A **report** is one of these: a mark that the estimate without fault does not have; a fault
//! answer; a hello frame that was not requested; a frame that is damaged, missing, of another
//! sample or out of sequence; a timeout; the end of the emulation; a tracked clearance that differs
//! by more than [`CLEARANCE_DEVIATIONS`] standard deviations.

use super::emulator::{PumpEnd, Received};
use super::plan::{Fault, Kind};
use super::scenario::Scenario;
use controller::flags::{NAMES, OVER_FORCE};
use link::track::TrackReport;
use link::{Answer, EstimateFrame, NumberedEstimate, SlowReport, ToHost};
use serde::{Deserialize, Serialize};

/// Error of an estimate up to which it is not wrong, as a share of full scale.
pub(crate) const BOUND_SHARE: f64 = 0.05;
/// Error of the tracked clearance that reports a fault, in standard deviations.
pub(crate) const CLEARANCE_DEVIATIONS: f64 = 4.0;

/// Class of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Class {
    /// Reported in time.
    Detected,
    /// Reported in time, and wrong without a mark afterwards.
    WrongAgain,
    /// Reported after wrong estimates.
    DetectedLate,
    /// No wrong estimate.
    Harmless,
    /// Wrong estimates without a report.
    Silent,
    /// Never injected.
    NotStruck,
}

impl Class {
    /// All classes.
    pub const ALL: [Self; 6] =
        [Self::Detected, Self::WrongAgain, Self::DetectedLate, Self::Harmless, Self::Silent, Self::NotStruck];
}

/// Result of a fault.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Number of the fault.
    pub number: u64,
    /// Kind of the fault.
    pub kind: Kind,
    /// Place and time of the fault.
    pub what: String,
    /// Class.
    pub class: Class,
    /// First report that the host received.
    pub first_report: Option<String>,
    /// Samples from the fault to the first report.
    pub latency: Option<u32>,
    /// Samples from the first wrong estimate to the first report, if the fault was detected late.
    pub late: Option<u32>,
    /// Largest error of an unmarked estimate, as a share of full scale.
    pub error_share: f64,
    /// Number of wrong estimates.
    pub wrong: u32,
    /// Number of wrong estimates after the first report.
    #[serde(rename = "wrong_again")]
    pub wrong_after_report: u32,
    /// True if any message differed from the run without fault: the fault hit something in use.
    pub alive: bool,
}

/// Findings while the received messages are read.
#[derive(Default)]
struct Observation {
    first_report: Option<(usize, String)>,
    first_wrong: Option<usize>,
    wrong: u32,
    wrong_after_report: u32,
    error_share: f64,
    alive: bool,
    /// Sample that the next estimate belongs to.
    sample: usize,
    /// Number of the last estimate.
    number: Option<u32>,
    hellos: u32,
}

impl Observation {
    fn report(&mut self, what: impl Into<String>) {
        self.report_at(self.sample, what);
    }

    fn report_at(&mut self, sample: usize, what: impl Into<String>) {
        self.alive = true;
        self.first_report.get_or_insert_with(|| (sample, what.into()));
    }

    fn read(&mut self, fault: &Fault, scenario: &Scenario, message: &Received) {
        match message {
            Ok(ToHost::Hello(hello)) if hello.token == 0 => {
                self.hellos += 1;
                if self.hellos > 1 {
                    self.report(format!("restart: {:?}", hello.start.reason).to_lowercase());
                }
            }
            Ok(
                ToHost::Hello(_) | ToHost::Slow(_) | ToHost::Update(_) | ToHost::Impact(_) | ToHost::Block(_),
            ) => {}
            Ok(ToHost::Fault(_)) => self.report("fault answer"),
            Err(_) => self.report("damaged frame"),
            Ok(ToHost::Acknowledged(acknowledgement)) => match acknowledgement.outcome {
                Ok(Answer::Report(SlowReport::Track(track))) => self.read_track(scenario, &track),
                Ok(_) => {}
                Err(_) => self.report("refused command"),
            },
            Ok(ToHost::Estimate(numbered)) => self.read_estimate(fault, scenario, numbered),
        }
    }

    fn read_track(&mut self, scenario: &Scenario, track: &TrackReport) {
        self.alive |= *track != scenario.track;
        let expected = f64::from(scenario.configuration.bench.radial_clearance_nm);
        let error = f64::from(track.radial_clearance_nm) - expected;
        let deviation = f64::from(track.radial_clearance_deviation_nm.max(1));
        if error.abs() > CLEARANCE_DEVIATIONS * deviation {
            self.report("tracked clearance");
        }
    }

    fn read_estimate(&mut self, fault: &Fault, scenario: &Scenario, numbered: &NumberedEstimate) {
        let estimate = &numbered.estimate;
        let gap = self.number.is_some_and(|last| numbered.number != last.wrapping_add(1));
        self.number = Some(numbered.number);
        let sample = estimate.sequence as usize;
        let Some(reference) = scenario.reference.get(sample).filter(|r| r.time_us == estimate.time_us) else {
            self.report("estimate of no sample");
            return;
        };
        // A host that waits for the estimate of one sample accepts no other.
        let skipped =
            sample != self.sample && !matches!(fault.kind, Kind::FrameDelayed | Kind::FramesReordered);
        if gap || (skipped && sample != self.sample.saturating_sub(1)) {
            self.report("missing estimate");
        }
        self.sample = sample + 1;
        self.compare(sample, scenario, reference, estimate);
    }

    fn compare(
        &mut self,
        sample: usize,
        scenario: &Scenario,
        reference: &EstimateFrame,
        estimate: &EstimateFrame,
    ) {
        if estimate.same_bits(reference) {
            return;
        }
        self.alive = true;
        let marks = estimate.flags & !reference.flags & !OVER_FORCE.bits();
        if let Some((_, name)) = NAMES.iter().find(|(flag, _)| marks & flag.bits() != 0) {
            self.report_at(sample, *name);
            return;
        }
        let share = error_share(scenario, reference, estimate);
        self.error_share = self.error_share.max(share);
        if share > BOUND_SHARE {
            self.wrong += 1;
            self.wrong_after_report += u32::from(self.first_report.is_some());
            self.first_wrong.get_or_insert(sample);
        }
    }
}

/// Classifies a fault by the messages that were received since the controller started.
#[must_use]
pub fn classify(fault: &Fault, scenario: &Scenario, received: &[Received], end: PumpEnd) -> Outcome {
    let mut observation = Observation::default();
    for message in received {
        observation.read(fault, scenario, message);
    }
    match end {
        PumpEnd::Arrived if observation.sample < scenario.reference.len() => {
            observation.report("missing estimate");
        }
        PumpEnd::Arrived => {}
        PumpEnd::Exited => observation.report("end"),
        PumpEnd::TimedOut | PumpEnd::Stopped => observation.report("time-out"),
    }
    conclude(fault, observation)
}

/// Returns the largest error of an estimate as a share of full scale; `f64::MAX` if it is not a
/// number.
fn error_share(scenario: &Scenario, reference: &EstimateFrame, estimate: &EstimateFrame) -> f64 {
    let error = |read: fn(&EstimateFrame) -> f32| f64::from(read(estimate) - read(reference));
    let turn = error(|e| e.contact_angle_rad) / std::f64::consts::TAU;
    let has_angle = reference.deformation_m > 0.0 || !turn.is_finite();
    let angle = if has_angle { 2.0 * (turn - turn.round()).abs() } else { 0.0 };
    let shares = [
        error(|e| e.normal_force_n).abs() / scenario.force_full_scale_n,
        error(|e| e.force_y_n).abs() / scenario.force_full_scale_n,
        error(|e| e.force_z_n).abs() / scenario.force_full_scale_n,
        error(|e| e.friction_torque_nm).abs() / scenario.torque_full_scale_nm,
        error(|e| e.deformation_m).abs() / scenario.deformation_full_scale_m,
        angle,
    ];
    let larger = |max: f64, share: f64| if share.is_finite() { max.max(share) } else { f64::MAX };
    shares.into_iter().fold(0.0, larger)
}

/// Returns the outcome of a fault that was never injected.
#[must_use]
pub fn not_struck(fault: &Fault) -> Outcome {
    Outcome { class: Class::NotStruck, ..conclude(fault, Observation::default()) }
}

fn conclude(fault: &Fault, observation: Observation) -> Outcome {
    let Observation { first_report, first_wrong, wrong, wrong_after_report, error_share, alive, .. } =
        observation;
    let class = match (&first_report, first_wrong) {
        (None, None) => Class::Harmless,
        (None, Some(_)) => Class::Silent,
        (Some((reported, _)), Some(wrong)) if wrong < *reported => Class::DetectedLate,
        (Some(_), Some(_)) if wrong_after_report > 0 => Class::WrongAgain,
        (Some(_), _) => Class::Detected,
    };
    let since = |from: usize| first_report.as_ref().map(|(at, _)| at.saturating_sub(from) as u32);
    Outcome {
        number: fault.number,
        kind: fault.kind,
        what: fault.description(),
        class,
        latency: since(fault.sample),
        late: first_wrong.filter(|_| class == Class::DetectedLate).and_then(since),
        first_report: first_report.map(|(_, what)| what),
        error_share,
        wrong,
        wrong_after_report,
        alive,
    }
}

#[cfg(test)]
mod tests;
