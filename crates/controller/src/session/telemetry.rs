//! Telemetry: counters, the schedule of slow reports, and the status of other parts of the
//! controller.

use inference::Flags;
use link::start::{PARTIES, Presence};
use link::update::UpdateStatus;
use link::{Counters, LineErrors, ReportKind, SamplingReport, SensorFrame};

use super::run::TimedEstimate;
use crate::flags::{MODEL_MISFIT, OVER_FORCE, SENSOR_FAULT, SEQUENCE_GAP, TIME_FAULT};

/// State of the parts of the controller that the session does not own, for its reports.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Status {
    /// Time since the start, us, modulo 2^32.
    pub(crate) uptime_us: u32,
    /// Check-ins in the order of [`PARTIES`].
    pub(crate) parties: [Presence; PARTIES.len()],
    /// State of the model store.
    pub(crate) models: UpdateStatus,
    /// Last sample of the controller's own sensors.
    pub(crate) sample: Option<SensorFrame>,
    /// Timing of those samples.
    pub(crate) sampling: Option<SamplingReport>,
}

/// Losses on the way in, counted since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LineReport {
    /// Received bytes without room in a buffer.
    pub dropped_bytes: u32,
    /// Errors that the port's hardware detected.
    pub errors: LineErrors,
}

/// Counters, schedule and status.
#[derive(Debug, Default)]
pub(super) struct Telemetry {
    pub(super) counters: Counters,
    pub(super) status: Status,
    pub(super) schedule: Schedule,
}

/// Schedule of the slow reports.
#[derive(Debug, Default)]
pub(super) struct Schedule {
    /// Samples until the next frame.
    remaining: u16,
    is_due: bool,
    /// Index in [`ReportKind::ALL`] of the next report.
    next: usize,
    /// Number of the next frame.
    number: u32,
    /// Sequence number of the last sample.
    pub(super) sequence: u32,
}

impl Schedule {
    /// Starts the interval of `every` samples.
    pub(super) const fn restart(&mut self, every: u16) {
        self.remaining = every;
    }

    pub(super) const fn is_due(&self) -> bool {
        self.is_due
    }

    /// Counts a sample. Returns whether a frame became due while the one before had not been
    /// fetched. The work does not depend on the data.
    fn advance(&mut self, sequence: u32, every: u16) -> bool {
        self.sequence = sequence;
        self.remaining = self.remaining.wrapping_sub(1);
        let ends = self.remaining == 0;
        let is_lost = ends & self.is_due;
        self.remaining = if ends { every } else { self.remaining };
        self.is_due |= ends & (every != 0);
        is_lost
    }

    /// Takes the due frame: the first report in turn that exists, with the frame's number.
    pub(super) fn take<R>(&mut self, report: impl Fn(ReportKind) -> Option<R>) -> Option<(u32, R)> {
        if !core::mem::take(&mut self.is_due) {
            return None;
        }
        for _ in ReportKind::ALL {
            let kind = ReportKind::ALL.get(self.next).copied().unwrap_or(ReportKind::Track);
            let is_last = self.next.saturating_add(1) >= ReportKind::ALL.len();
            self.next = if is_last { 0 } else { self.next.saturating_add(1) };
            if let Some(report) = report(kind) {
                let number = self.number;
                self.number = number.wrapping_add(1);
                return Some((number, report));
            }
        }
        None
    }
}

impl Telemetry {
    /// Counts a sample with its estimate; `every` is the interval of slow reports in samples.
    pub(super) fn count_sample(&mut self, timed: &TimedEstimate, sequence: u32, every: u16) {
        let flags = Flags::from_bits(timed.estimate.estimate.flags);
        let counters = &mut self.counters;
        count(&mut counters.samples, true);
        count(&mut counters.flagged, flags.intersects(SENSOR_FAULT | MODEL_MISFIT));
        count(&mut counters.sequence_gaps, flags.contains(SEQUENCE_GAP));
        count(&mut counters.time_faults, flags.contains(TIME_FAULT));
        count(&mut counters.over_force, flags.contains(OVER_FORCE));
        count(&mut counters.deadline_overruns, timed.is_late);
        count(&mut counters.trips, timed.trips);
        count(&mut counters.held, timed.is_held);
        let is_lost = self.schedule.advance(sequence, every);
        count(&mut counters.dropped_answers, is_lost);
    }

    /// Resets the counters of a run. The counters of the link continue.
    pub(super) fn reset_run(&mut self) {
        let Counters {
            dropped_answers,
            repeated_commands,
            refused_commands,
            dropped_bytes,
            line_errors,
            bad_frames,
            ..
        } = self.counters;
        self.counters = Counters {
            dropped_answers,
            repeated_commands,
            refused_commands,
            dropped_bytes,
            line_errors,
            bad_frames,
            ..Counters::default()
        };
    }
}

/// Increments a counter if something happened. It stops at its maximum.
pub(super) fn count(counter: &mut u32, happened: bool) {
    *counter = counter.saturating_add(u32::from(happened));
}
