//! The controller's side of the link session: a message in, a message out.
//!
//! A session waits after a start and after [`Command::Stop`]. [`Command::Configure`] starts a run
//! with one estimate per sample. Too many late estimates trip the controller until
//! [`Command::ClearTrip`]. Samples before a configuration are refused. Every refusal has a name,
//! and every loss is counted.
//!
//! Commands are executed once, in the order of their numbers, and answered as often as they arrive:
//! see [`link::Command`].
//!
//! Parts: [`conversation`] (hello frame, command numbers), [`telemetry`] (counters, reports),
//! [`run`] (estimator, deadline, numbering of the estimates).
//!
//! [`Command::Stop`]: link::Command::Stop
//! [`Command::Configure`]: link::Command::Configure
//! [`Command::ClearTrip`]: link::Command::ClearTrip

mod commands;
mod conversation;
mod deadline;
mod run;
mod telemetry;
#[cfg(test)]
mod tests;
mod ticks;

use link::authentication::Authentication;
use link::start::{KeptConfiguration, StackReport, StartReport, SupervisorReport};
use link::track::SensorStatus;
use link::update::{UpdateAnswer, UpdateRefusal};
use link::{
    BlockSummary, ControllerConfiguration, Counters, ESTIMATE_FRAME, Fault, FrameError, Hello,
    NumberedEstimate, Refusal, ReportKind, SensorFrame, SlowFrame, SlowReport, State, Target, ToController,
    ToHost, encode_estimate,
};

use crate::configuration::wiring;
use crate::impacts::{Found, Queue};
use crate::integrity::{Guarded, WordSum};
use crate::sensors::Wiring;
use crate::store::Models;
use conversation::Conversation;
pub use conversation::Identity;
use run::Run;
pub use run::{OwnSampling, own_estimate_interval};
pub use telemetry::LineReport;
pub(crate) use telemetry::Status;
use telemetry::{Telemetry, count};
pub use ticks::{NoTicks, TickSource};

/// Period of the timer without a run, us.
pub const IDLE_PERIOD_US: u32 = 100;

/// A frame of an estimate that waits for the link service, with the block that it ends.
#[derive(Clone, Debug)]
pub(crate) struct SentEstimate {
    pub(crate) frame: [u8; ESTIMATE_FRAME],
    /// Only with own samples.
    pub(crate) block: Option<Guarded<BlockSummary>>,
}

/// One link session.
#[derive(Debug)]
#[repr(C)]
pub struct Session {
    run: Option<Run>,
    conversation: Conversation,
    telemetry: Telemetry,
    models: Models,
    /// The configuration accepted last; it outlives its run.
    configuration: Option<ControllerConfiguration>,
    /// True if that configuration has just been saved.
    is_saved: bool,
    /// Shortest period of own samples, us; `None` without sensors.
    own_sampling: Option<OwnSampling>,
    /// True until the wiring of the configuration has been taken.
    has_new_wiring: bool,
    /// Impacts that have not been sent.
    impacts: Queue,
}

impl Session {
    /// Creates a session that waits to be configured, with the models built into the firmware.
    #[must_use]
    pub fn new(identity: Identity) -> Self {
        let models = Models::built_in();
        Self {
            conversation: Conversation::new(identity, models.ids()),
            telemetry: Telemetry::default(),
            models,
            configuration: None,
            is_saved: false,
            own_sampling: None,
            has_new_wiring: false,
            run: None,
            impacts: Queue::default(),
        }
    }

    /// Uses other models from the next sample on. The networks' history restarts and is flagged so.
    pub fn switch_models(&mut self, models: Models) {
        self.conversation.set_models(models.ids());
        self.models = models;
        if let Some(run) = &mut self.run {
            run.switch(&self.models);
        }
    }

    /// Returns true once when the model in use is found corrupted: a bit differs from when it was
    /// loaded. Until an intact model is switched to, every estimate is flagged so.
    pub fn take_model_corruption(&mut self) -> bool {
        self.run.as_mut().is_some_and(Run::take_model_corruption)
    }

    /// Returns true if a bit of what the configuration sets has flipped. Call it often during a
    /// run.
    #[must_use]
    pub(crate) fn is_configuration_corrupted(&self) -> bool {
        self.run.as_ref().is_some_and(Run::is_configuration_corrupted)
    }

    /// Notes that the code in flash is not what was built: every configuration is refused, and the
    /// hello frame names no model.
    pub(crate) const fn mark_code_corrupted(&mut self) {
        self.conversation.mark_code_corrupted();
    }

    /// Sets the reason of the start for the hello frame.
    pub const fn set_start_report(&mut self, start: StartReport) {
        self.conversation.set_start_report(start);
    }

    /// Sets the use of the kept configuration for the hello frame.
    pub(crate) const fn set_kept_configuration(&mut self, kept: KeptConfiguration) {
        self.conversation.set_kept_configuration(kept);
    }

    /// Sets the authentication that commands require, for the hello frame.
    pub const fn set_authentication(&mut self, authentication: Authentication) {
        self.conversation.set_authentication(authentication);
    }

    /// Sets the use of the stack for the hello frame.
    pub(crate) const fn set_stack_report(&mut self, stack: StackReport) {
        self.conversation.set_stack_report(stack);
    }

    /// Sets the status of the other parts for the reports. To be called before a command is handled
    /// and whenever [`Session::is_telemetry_due`].
    pub(crate) const fn update_status(&mut self, status: Status) {
        self.telemetry.status = status;
    }

    /// Sets the limits of the controller's own samples; `None` without sensors or without a timer
    /// that paces them.
    pub const fn set_own_sampling(&mut self, own_sampling: Option<OwnSampling>) {
        self.own_sampling = own_sampling;
    }

    /// Returns the period of the timer that paces the samples, us: the configured sample period, or
    /// [`IDLE_PERIOD_US`] without a run.
    #[must_use]
    pub fn sample_period_us(&self) -> u32 {
        self.run.as_ref().map_or(IDLE_PERIOD_US, |run| run.configuration.bench.sample_period_us)
    }

    /// Returns the wiring of a newly accepted configuration once, for the controller's own sensors.
    pub(crate) fn take_wiring(&mut self) -> Option<Wiring> {
        let is_new = core::mem::replace(&mut self.has_new_wiring, false);
        self.configuration.as_ref().filter(|_| is_new).and_then(wiring)
    }

    /// Continues the run on the controller's own samples. Returns the number of samples per sent
    /// estimate.
    ///
    /// # Errors
    ///
    /// Nothing is configured, there are no sensors, or a tick takes longer than the bench's sample
    /// period.
    pub(crate) fn start_sampling(&mut self) -> Result<u16, Refusal> {
        let run = self.run.as_mut().ok_or(Refusal::NotConfigured)?;
        let own_sampling = self.own_sampling.ok_or(Refusal::NoSensors)?;
        run.start_sampling(&own_sampling).map_err(Refusal::Configuration)
    }

    /// Decides whether the run uses the controller's own samples: then [`Session::tick_own_sample`]
    /// is due every timer tick.
    #[must_use]
    pub(crate) fn is_sampling(&self) -> bool {
        self.run.as_ref().is_some_and(Run::is_sampling)
    }

    /// Returns the hello frame's content. `token` is that of the request, 0 without one.
    #[must_use]
    pub fn hello(&self, token: u32) -> Hello {
        self.conversation.hello(token, self.state())
    }

    /// Returns the state of the session.
    #[must_use]
    pub fn state(&self) -> State {
        match &self.run {
            None => State::Waiting,
            Some(run) if run.deadline.is_tripped() => State::Tripped,
            Some(_) => State::Running,
        }
    }

    /// Returns the counters.
    #[must_use]
    pub const fn counters(&self) -> &Counters {
        &self.telemetry.counters
    }

    /// Handles one message and returns the reply.
    pub fn handle(&mut self, message: &ToController, ticks: &mut impl TickSource) -> ToHost {
        match message {
            ToController::Identify { token } => ToHost::Hello(self.hello(*token)),
            ToController::Command(numbered) | ToController::Authenticated(numbered, _) => {
                ToHost::Acknowledged(self.acknowledge(numbered))
            }
            ToController::Sensor(frame, status) => {
                let start = ticks.start();
                match self.estimate(frame, *status, start, ticks) {
                    Some((estimate, elapsed)) => {
                        self.finish(elapsed, ticks.since(start));
                        ToHost::Estimate(estimate)
                    }
                    None => not_configured(frame),
                }
            }
            // A controller with a model store handles these before.
            ToController::Update(_) => ToHost::Update(UpdateAnswer::Refused(UpdateRefusal::NoMemory)),
        }
    }

    /// Runs a complete tick: takes a sample and returns the frame of its estimate, whose
    /// `instruction_ticks` are those of the tick before.
    ///
    /// # Errors
    ///
    /// Nothing is configured.
    pub fn tick(
        &mut self,
        frame: &SensorFrame,
        status: SensorStatus,
        ticks: &mut impl TickSource,
    ) -> Result<[u8; ESTIMATE_FRAME], ToHost> {
        let start = ticks.start();
        self.timed_tick(frame, status, start, ticks).ok_or_else(|| not_configured(frame))
    }

    /// Runs a complete tick with the controller's own sample; taking the sample counts towards the
    /// deadline. Returns the estimate with its block if it is one of those that are sent.
    pub(crate) fn tick_own_sample(
        &mut self,
        sample: impl FnOnce() -> (SensorFrame, SensorStatus),
        ticks: &mut impl TickSource,
    ) -> Option<SentEstimate> {
        let start = ticks.start();
        let (frame, status) = sample();
        let frame = self.timed_tick(&frame, status, start, ticks)?;
        let run = self.run.as_mut()?;
        run.take_turn().then(|| SentEstimate { frame, block: Some(run.take_block()) })
    }

    /// Counts a frame that could not be decoded and returns the reply for a waiting host.
    pub fn bad_frame(&mut self, error: FrameError) -> ToHost {
        self.telemetry.counters.bad_frames.count(error);
        ToHost::Fault(Fault::BadFrame(error))
    }

    /// Decides whether a frame of slow telemetry is due.
    #[must_use]
    pub(crate) const fn is_telemetry_due(&self) -> bool {
        self.telemetry.schedule.is_due()
    }

    /// Takes the frame of slow telemetry that is due. The reports take turns; one without content
    /// is skipped.
    pub fn take_telemetry(&mut self) -> Option<ToHost> {
        let mut schedule = core::mem::take(&mut self.telemetry.schedule);
        let frame = schedule.take(|kind| self.report(kind));
        self.telemetry.schedule = schedule;
        let (number, report) = frame?;
        let (sequence, state) = (self.telemetry.schedule.sequence, self.state());
        Some(ToHost::Slow(SlowFrame { number, sequence, state, report }))
    }

    /// Takes the oldest impact that has not been sent. A record that was corrupted is counted as
    /// dropped.
    pub fn take_impact(&mut self) -> Option<ToHost> {
        loop {
            match self.impacts.pop()? {
                Ok(record) => return Some(ToHost::Impact(record)),
                Err(()) => self.count_dropped_impact(),
            }
        }
    }

    /// Returns a report as of now; `None` for a report of a run without a run.
    fn report(&self, kind: ReportKind) -> Option<SlowReport> {
        let monitor = self.run.as_ref().map(|run| &run.monitor);
        let status = &self.telemetry.status;
        Some(match kind {
            ReportKind::Track => SlowReport::Track(monitor?.report()),
            ReportKind::Sensors => SlowReport::Sensors(monitor?.health()),
            ReportKind::Counters => SlowReport::Counters(self.telemetry.counters),
            ReportKind::Supervisor => {
                let (start, stack) = self.conversation.start_and_stack();
                let (uptime_us, parties) = (status.uptime_us, status.parties);
                SlowReport::Supervisor(SupervisorReport { uptime_us, parties, start, stack })
            }
            ReportKind::Models => SlowReport::Models(status.models),
            ReportKind::Estimate => {
                let estimate = *self.run.as_ref()?.last();
                SlowReport::Estimate(NumberedEstimate { number: 0, dropped: 0, estimate }.into())
            }
            ReportKind::Sample => SlowReport::Sample(status.sample?),
            ReportKind::Sampling => SlowReport::Sampling(status.sampling?),
        })
    }

    /// Counts a timer tick of a configured session without a sample. In lockstep the timer paces
    /// nothing.
    pub(crate) fn count_idle_tick(&mut self) {
        let is_idle = self.run.is_some() && self.conversation.target() == Target::Silicon;
        count(&mut self.telemetry.counters.idle_ticks, is_idle);
    }

    /// Counts a sample without room in the queue.
    pub(crate) fn count_dropped_sample(&mut self) {
        count(&mut self.telemetry.counters.dropped_samples, true);
    }

    /// Counts an estimate without room in the queue or that the transport did not take.
    pub(crate) fn count_dropped_estimate(&mut self) {
        count(&mut self.telemetry.counters.dropped_estimates, true);
    }

    /// Counts a record of an impact that the transport did not take.
    pub(crate) fn count_dropped_impact(&mut self) {
        count(&mut self.telemetry.counters.dropped_impacts, true);
    }

    /// Counts another reply that the transport did not take.
    pub(crate) fn count_dropped_answer(&mut self) {
        count(&mut self.telemetry.counters.dropped_answers, true);
    }

    /// Sets the counters of bytes that were lost on the way in.
    pub(crate) const fn set_line_report(&mut self, line: LineReport) {
        self.telemetry.counters.dropped_bytes = line.dropped_bytes;
        self.telemetry.counters.line_errors = line.errors;
    }

    /// Runs a tick whose time counts from `start` on. Returns `None` if nothing is configured.
    #[inline]
    fn timed_tick(
        &mut self,
        frame: &SensorFrame,
        status: SensorStatus,
        start: u32,
        ticks: &mut impl TickSource,
    ) -> Option<[u8; ESTIMATE_FRAME]> {
        let (estimate, elapsed) = self.estimate(frame, status, start, ticks)?;
        let mut bytes = [0; ESTIMATE_FRAME];
        self.encode(&estimate, &mut bytes);
        self.finish(elapsed, ticks.since(start));
        Some(bytes)
    }

    /// Estimates, watches the deadline and counts. Returns the estimate and the ticks it took so
    /// far.
    fn estimate(
        &mut self,
        frame: &SensorFrame,
        status: SensorStatus,
        start: u32,
        ticks: &mut impl TickSource,
    ) -> Option<(NumberedEstimate, u32)> {
        let run = self.run.as_mut()?;
        let estimate = run.estimate(frame, status);
        let elapsed = ticks.since(start);
        let mut timed = run.finish_estimate(estimate, elapsed);
        timed.estimate.dropped = self.telemetry.counters.dropped_estimates as u8;
        self.telemetry.count_sample(&timed, frame.sequence, run.configuration.limits.slow_every);
        let found = run.follow_impacts(&timed.estimate.estimate);
        if let Some(found) = &found {
            self.store_impact(found);
        }
        Some((timed.estimate, elapsed))
    }

    /// Counts and queues an impact that has ended.
    #[cold]
    fn store_impact(&mut self, found: &Found) {
        let is_dropped = match found {
            Found::Impact(record) => {
                count(&mut self.telemetry.counters.impacts, true);
                !self.impacts.push(*record)
            }
            Found::Corruption => true,
        };
        count(&mut self.telemetry.counters.dropped_impacts, is_dropped);
    }

    /// Ends an open impact with its run. The next run numbers its impacts from 0.
    fn finish_impacts(&mut self) {
        if let Some(found) = self.run.as_mut().and_then(Run::finish_impacts) {
            self.store_impact(&found);
        }
        self.impacts.restart_numbers();
    }

    /// Encodes an estimate. The CRC of the frame is wrong if a bit of the values has flipped since
    /// they were computed.
    fn encode(&self, estimate: &NumberedEstimate, bytes: &mut [u8; ESTIMATE_FRAME]) {
        let computed = self.run.as_ref().map_or_else(WordSum::default, Run::value_sum);
        encode_estimate(estimate, |values| WordSum::from_words(values).difference(computed), bytes);
    }

    fn finish(&mut self, elapsed: u32, total: u32) {
        if let Some(run) = &mut self.run {
            run.deadline.finish(elapsed, total);
        }
    }
}

fn not_configured(frame: &SensorFrame) -> ToHost {
    ToHost::Fault(Fault::NotConfigured { sequence: frame.sequence })
}
