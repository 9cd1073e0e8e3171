//! The controller's side of the conversation with the host: a message in, a message out.
//!
//! Waiting (after start or [`Command::Stop`]) -> running by [`Command::Configure`] -> one estimate a sample. Too many late estimates trip
//! the controller until [`Command::ClearTrip`]. Nothing is served before it is configured; every refusal has a name, everything lost
//! a count.
//!
//! Commands are carried out once, in the order of their numbers, and answered as often as they come: see [`link::Command`].

mod commands;
mod deadline;
mod run;
#[cfg(test)]
mod tests;

use link::start::{PARTIES, Presence, StackReport, StartReport, SupervisorReport};
use link::track::SensorStatus;
use link::update::{UpdateAnswer, UpdateRefusal, UpdateStatus};
use link::{
    BuildId, ClockSource, ControllerConfiguration, Counters, ESTIMATE_FRAME, Fault, FrameError, Hello,
    LineErrors, MAGIC, ModelId, NumberedEstimate, PROTOCOL_VERSION, Refused, ReportKind, SensorFrame,
    SlowFrame, SlowReport, State, Target, ToController, ToHost, encode_estimate,
};

use crate::configuration::wiring;
use crate::estimator::WINDOW;
use crate::flags::{LOAD_CONTRADICTED, OVER_FORCE, SENSOR_FAULT, SEQUENCE_GAP, TIME_FAULT};
use crate::sensors::Wiring;
use crate::store::Models;
use commands::LastCommand;
pub use run::{OWN_EVERY, OWN_PERIOD_US};
use run::{Run, flags_of};

/// A free-running counter that times one tick's work.
pub trait TickSource {
    /// Takes the count at the start of the work.
    fn start(&mut self) -> u32;
    /// Ticks since `start`.
    fn since(&mut self, start: u32) -> u32;
}

/// No counter: every duration is 0.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoTicks;

impl TickSource for NoTicks {
    fn start(&mut self) -> u32 {
        0
    }

    fn since(&mut self, _start: u32) -> u32 {
        0
    }
}

/// What the controller says about itself in a [`Hello`].
#[derive(Clone, Copy, Debug)]
pub struct Identity {
    /// Name of the build.
    pub build_id: BuildId,
    /// Where it runs.
    pub target: Target,
    /// What drives the core.
    pub clock: ClockSource,
    /// Core frequency, Hz.
    pub core_hz: u32,
}

/// One conversation.
#[derive(Debug)]
pub struct Session {
    hello: Hello,
    models: Models,
    /// The configuration accepted last; it outlives its run.
    configuration: Option<ControllerConfiguration>,
    /// Whether that configuration has just been kept.
    kept: bool,
    /// Whether the controller has sensors of its own.
    has_sensors: bool,
    /// Whether a configuration's wiring has not been fetched.
    rewired: bool,
    /// Whether the code in flash was found altered at the start.
    code_altered: bool,
    /// Sum of the run's constants, once it has been asked for.
    constants: Option<u32>,
    run: Option<Run>,
    counters: Counters,
    commands: LastCommand,
    slow: Slow,
    beside: Beside,
}

/// What others than the session know, for its reports.
#[derive(Debug, Default)]
struct Beside {
    uptime_us: u32,
    parties: [Presence; PARTIES.len()],
    models: UpdateStatus,
    sample: Option<SensorFrame>,
}

/// Where slow telemetry stands.
#[derive(Debug, Default)]
struct Slow {
    /// Samples until the next frame.
    left: u16,
    due: bool,
    /// Position of the report whose turn it is.
    turn: usize,
    number: u32,
    sequence: u32,
}

impl Session {
    /// Creates a session that waits to be configured, with the models built into the firmware.
    #[must_use]
    pub fn new(identity: Identity) -> Self {
        let models = Models::built_in();
        let hello = Hello {
            magic: MAGIC,
            protocol: PROTOCOL_VERSION,
            build_id: identity.build_id,
            target: identity.target,
            clock: identity.clock,
            core_hz: identity.core_hz,
            window: WINDOW as u16,
            models: models.ids(),
            token: 0,
            last_command: 0,
            state: State::Waiting,
            configuration_crc: 0,
            start: StartReport::default(),
            stack: StackReport::default(),
        };
        Self {
            hello,
            models,
            configuration: None,
            kept: false,
            has_sensors: false,
            rewired: false,
            code_altered: false,
            constants: None,
            run: None,
            counters: Counters::default(),
            commands: LastCommand::default(),
            slow: Slow::default(),
            beside: Beside::default(),
        }
    }

    /// Goes on with other models from the next sample on. The networks' history starts anew, and is flagged so.
    pub fn switch(&mut self, models: Models) {
        // With altered code it goes on to name none.
        if !self.code_altered {
            self.hello.models = models.ids();
        }
        self.models = models;
        self.constants = None;
        if let Some(run) = &mut self.run {
            run.switch(&self.models);
        }
    }

    /// Whether the model in use has been found altered since this was asked last: a bit of it is not what it was when it was loaded. Until a
    /// sound one is switched to, every estimate is flagged so.
    pub fn take_altered(&mut self) -> bool {
        self.run.as_mut().is_some_and(Run::take_altered)
    }

    /// Whether what the configuration set is still what it was when this was asked first since the run began or its models were switched.
    /// To be asked often, the first time at once.
    pub fn constants_hold(&mut self) -> bool {
        let Some(run) = &self.run else { return true };
        let sum = run.constants();
        *self.constants.get_or_insert(sum) == sum
    }

    /// Takes that the code in flash is not what was built: every configuration is refused, and the greeting names no model.
    pub fn distrust_code(&mut self) {
        self.code_altered = true;
        self.hello.models = [ModelId { crc: 0, training_id: 0 }; 2];
    }

    /// Takes what the greeting is to say of the start.
    pub const fn report_start(&mut self, start: StartReport) {
        self.hello.start = start;
    }

    /// Takes what the greeting is to say of the stack.
    pub const fn report_stack(&mut self, stack: StackReport) {
        self.hello.stack = stack;
    }

    /// Takes who has checked in, at what time since the start, how the models on board stand and the last sample of the controller's own
    /// sensors: to be called before a command is served and whenever [`Session::slow_is_due`].
    pub const fn report_beside(
        &mut self,
        uptime_us: u32,
        parties: [Presence; PARTIES.len()],
        models: UpdateStatus,
        sample: Option<SensorFrame>,
    ) {
        self.beside = Beside { uptime_us, parties, models, sample };
    }

    fn supervisor(&self) -> SupervisorReport {
        let Beside { uptime_us, parties, .. } = self.beside;
        SupervisorReport { uptime_us, parties, start: self.hello.start, stack: self.hello.stack }
    }

    /// Takes whether the controller has sensors of its own, with a timer that paces it.
    pub const fn report_sensors(&mut self, has_sensors: bool) {
        self.has_sensors = has_sensors;
    }

    /// The wiring of a configuration that has been accepted since this was asked last: for the controller's own sensors.
    pub fn take_wiring(&mut self) -> Option<Wiring> {
        let rewired = core::mem::replace(&mut self.rewired, false);
        self.configuration.as_ref().filter(|_| rewired).and_then(wiring)
    }

    /// Goes on with the run on the controller's own samples; returns one in how many estimates is sent.
    ///
    /// # Errors
    ///
    /// Nothing is configured, there are no sensors, or the bench's sample period is not the timer's.
    pub fn sample_itself(&mut self) -> Result<u16, Refused> {
        let run = self.run.as_mut().ok_or(Refused::NotConfigured)?;
        if !self.has_sensors {
            return Err(Refused::NoSensors);
        }
        run.sample_itself().map_err(Refused::Configuration)?;
        self.constants = None;
        Ok(OWN_EVERY)
    }

    /// Whether the run is on the controller's own samples: [`Session::own_tick`] is due every timer tick.
    #[must_use]
    pub fn samples_itself(&self) -> bool {
        self.run.as_ref().is_some_and(Run::samples_itself)
    }

    /// The greeting; with the token of whoever asked, 0 for nobody.
    #[must_use]
    pub fn hello(&self, token: u32) -> Hello {
        Hello { token, last_command: self.commands.number(), state: self.state(), ..self.hello }
    }

    /// What the controller is doing.
    #[must_use]
    pub fn state(&self) -> State {
        match &self.run {
            None => State::Waiting,
            Some(run) if run.deadline.tripped() => State::Tripped,
            Some(_) => State::Running,
        }
    }

    /// What was counted so far.
    #[must_use]
    pub const fn counters(&self) -> &Counters {
        &self.counters
    }

    /// Serves one message.
    pub fn handle(&mut self, message: &ToController, ticks: &mut impl TickSource) -> ToHost {
        match message {
            ToController::Identify { token } => ToHost::Hello(self.hello(*token)),
            ToController::Command(numbered) => ToHost::Acknowledged(self.command(numbered)),
            ToController::Sensor(frame, status) => {
                let start = ticks.start();
                match self.sample(frame, *status, start, ticks) {
                    Some((estimate, elapsed)) => {
                        self.finish(elapsed, ticks.since(start));
                        ToHost::Estimate(estimate)
                    }
                    None => not_configured(frame),
                }
            }
            // Whoever has a store serves these before they come here.
            ToController::Update(_) => ToHost::Update(UpdateAnswer::Refused(UpdateRefusal::NoMemory)),
        }
    }

    /// A whole tick: a sample in, the bytes of its estimate out, and both in time. The estimate tells how long the tick before it took.
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
        let (estimate, elapsed) =
            self.sample(frame, status, start, ticks).ok_or_else(|| not_configured(frame))?;
        let mut bytes = [0; ESTIMATE_FRAME];
        self.encode(&estimate, &mut bytes);
        self.finish(elapsed, ticks.since(start));
        Ok(bytes)
    }

    /// A whole tick with the controller's own sample, whose taking is part of the time that is watched. The bytes of the estimate if it is
    /// one of those that are sent.
    pub fn own_tick(
        &mut self,
        sample: impl FnOnce() -> (SensorFrame, SensorStatus),
        ticks: &mut impl TickSource,
    ) -> Option<[u8; ESTIMATE_FRAME]> {
        let start = ticks.start();
        let (frame, status) = sample();
        let (estimate, elapsed) = self.sample(&frame, status, start, ticks)?;
        let mut bytes = [0; ESTIMATE_FRAME];
        self.encode(&estimate, &mut bytes);
        self.finish(elapsed, ticks.since(start));
        self.run.as_mut().is_some_and(Run::sends).then_some(bytes)
    }

    /// Counts a frame that could not be read, and answers it so that a waiting host learns of it.
    pub fn bad_frame(&mut self, error: FrameError) -> ToHost {
        self.counters.bad_frames.count(error);
        ToHost::Fault(Fault::BadFrame(error))
    }

    /// Whether a frame of slow telemetry is due.
    #[must_use]
    pub const fn slow_is_due(&self) -> bool {
        self.slow.due
    }

    /// The frame of slow telemetry that is due, if one is. The reports take turns; one that there is nothing for is passed over.
    pub fn slow(&mut self) -> Option<ToHost> {
        if !core::mem::take(&mut self.slow.due) {
            return None;
        }
        let (sequence, state) = (self.slow.sequence, self.state());
        for _ in ReportKind::ALL {
            let kind = ReportKind::ALL.get(self.slow.turn).copied().unwrap_or(ReportKind::Track);
            self.slow.turn = if kind == ReportKind::Sample { 0 } else { self.slow.turn.saturating_add(1) };
            if let Some(report) = self.report(kind) {
                let number = self.slow.number;
                self.slow.number = number.wrapping_add(1);
                return Some(ToHost::Slow(SlowFrame { number, sequence, state, report }));
            }
        }
        None
    }

    /// A report as it stands now; none of a run without a run.
    fn report(&self, kind: ReportKind) -> Option<SlowReport> {
        let monitor = self.run.as_ref().map(|run| &run.monitor);
        Some(match kind {
            ReportKind::Track => SlowReport::Track(monitor?.report()),
            ReportKind::Sensors => SlowReport::Sensors(monitor?.health()),
            ReportKind::Counters => SlowReport::Counters(self.counters),
            ReportKind::Supervisor => SlowReport::Supervisor(self.supervisor()),
            ReportKind::Models => SlowReport::Models(self.beside.models),
            ReportKind::Estimate => {
                let estimate = *self.run.as_ref()?.last();
                SlowReport::Estimate(NumberedEstimate { number: 0, dropped: 0, estimate }.into())
            }
            ReportKind::Sample => SlowReport::Sample(self.beside.sample?),
        })
    }

    /// Counts a timer tick of a configured session that found no sample waiting. In lockstep the timer paces nothing.
    pub fn count_idle_tick(&mut self) {
        count(&mut self.counters.idle_ticks, self.run.is_some() && self.hello.target == Target::Silicon);
    }

    /// Counts a sample that was dropped because there was no room for it.
    pub fn count_dropped_sample(&mut self) {
        count(&mut self.counters.dropped_samples, true);
    }

    /// Counts an estimate that was dropped: no room for it, or the line did not take it.
    pub fn count_dropped_estimate(&mut self) {
        count(&mut self.counters.dropped_estimates, true);
    }

    /// Counts another answer that was dropped.
    pub fn count_dropped_answer(&mut self) {
        count(&mut self.counters.dropped_answers, true);
    }

    /// Takes what was lost on the way in so far: bytes that found no room, and what the port itself found wrong.
    pub const fn report_line(&mut self, dropped_bytes: u32, line_errors: LineErrors) {
        self.counters.dropped_bytes = dropped_bytes;
        self.counters.line_errors = line_errors;
    }

    /// Estimates, watches the deadline and counts; returns the estimate and the ticks it took up to here.
    fn sample(
        &mut self,
        frame: &SensorFrame,
        status: SensorStatus,
        start: u32,
        ticks: &mut impl TickSource,
    ) -> Option<(NumberedEstimate, u32)> {
        let run = self.run.as_mut()?;
        let estimate = run.estimate(frame, status);
        let elapsed = ticks.since(start);
        let mut numbered = run.number(estimate, elapsed);
        numbered.estimate.dropped = self.counters.dropped_estimates as u8;

        let flags = flags_of(&numbered.estimate.estimate);
        let counters = &mut self.counters;
        count(&mut counters.samples, true);
        count(&mut counters.flagged, flags.intersects(SENSOR_FAULT | LOAD_CONTRADICTED));
        count(&mut counters.sequence_gaps, flags.contains(SEQUENCE_GAP));
        count(&mut counters.time_faults, flags.contains(TIME_FAULT));
        count(&mut counters.over_force, flags.contains(OVER_FORCE));
        count(&mut counters.deadline_overruns, numbered.late);
        count(&mut counters.trips, numbered.trips);
        count(&mut counters.held, numbered.held);
        let slow = &mut self.slow;
        slow.sequence = frame.sequence;
        slow.left = slow.left.wrapping_sub(1);
        let ends = slow.left == 0;
        let every = run.configuration.limits.slow_every;
        // Nobody fetched the last one.
        count(&mut counters.dropped_answers, ends & slow.due);
        slow.left = if ends { every } else { slow.left };
        slow.due |= ends & (every != 0);
        Some((numbered.estimate, elapsed))
    }

    /// The bytes of an estimate; they do not check where one of its numbers has been altered since it was given.
    fn encode(&self, estimate: &NumberedEstimate, bytes: &mut [u8; ESTIMATE_FRAME]) {
        encode_estimate(estimate, self.run.as_ref().map_or(0, Run::parity), bytes);
    }

    fn finish(&mut self, elapsed: u32, whole: u32) {
        if let Some(run) = &mut self.run {
            run.deadline.finished(elapsed, whole);
        }
    }
}

fn not_configured(frame: &SensorFrame) -> ToHost {
    ToHost::Fault(Fault::NotConfigured { sequence: frame.sequence })
}

fn count(counter: &mut u32, happened: bool) {
    *counter = counter.saturating_add(u32::from(happened));
}
