//! The link service: everything that the controller does outside the timer tick.
//!
//! One pass of the service's loop ([`LinkService::pass`]) receives and decodes frames, serves at
//! most one request, replaces corrupted models, sends the estimates and the telemetry that are due,
//! and runs one step of the background checks. The number of bytes and of replies per pass is
//! bounded, so that a flood of requests does not delay the estimates.
//!
//! The service is generic over the transport ([`Transport`]), the board ([`Platform`]) and the lock
//! of the state that the tick shares ([`SharedSession`]). The host tests it with a scripted
//! transport.

mod background;
mod command_guard;
mod journal;
mod pace;
mod sending;
mod shared_session;
mod stores;
mod transport;

#[cfg(test)]
mod tests;

use link::authentication::LinkKey;
use link::start::{KeptConfiguration, PARTIES, Presence};
use link::track::SensorStatus;
use link::update::{UpdateAnswer, UpdateRefusal, UpdateRequest};
use link::{Acknowledgement, Answer, Command, FrameError, Hello, SensorFrame, State, ToController, ToHost};
use rtic_core::Mutex;

pub use crate::session::LineReport;
use crate::session::{NoTicks, Status};
use crate::store::SlotMemory;
use crate::supervisor::Party;
use crate::supervisor::start::StartWatch;
pub use background::{Background, Platform};
pub use command_guard::{CommandGuard, LINK_KEY};
use journal::Journal;
pub use journal::{LogEvent, LoggedState, Losses};
pub use pace::{Pace, Pacing};
use sending::{send, send_estimates, send_impacts};
pub use shared_session::{SampleSource, SharedSession, Tick};
pub use stores::Stores;
use transport::Event;
pub use transport::{Ports, Purpose, Received, Transport, Unconnected};

/// Maximum number of received bytes that one pass reads.
const MAX_BYTES_PER_PASS: usize = 256;

/// Number of faulted starts in a row after which the kept configuration is set aside.
pub const MAX_FAULTED_STARTS: u8 = 3;
/// Time after which a start has not faulted, us.
const FAULTLESS_US: u32 = 60_000_000;

/// Reason for the end of the service.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// The host has closed the transport.
    Closed,
    /// Code in flash or the configuration in RAM is corrupted: the controller must restart.
    Corrupted,
}

/// The service with everything that only it uses.
pub struct LinkService<M> {
    pacing: Pacing,
    stores: Stores<M>,
    /// `None` if the firmware has no key.
    guard: Option<CommandGuard>,
    background: Background,
    journal: Journal,
}

impl<M: SlotMemory> LinkService<M> {
    /// Creates the service. With a key, commands that change the state must be authenticated, and
    /// the number of this start is kept now: later, writing flash could stall a run.
    pub fn new(pacing: Pacing, mut stores: Stores<M>, key: Option<LinkKey>, background: Background) -> Self {
        let guard = key.map(|key| CommandGuard::new(key, stores.next_start()));
        Self { pacing, stores, guard, background, journal: Journal::default() }
    }

    /// Restores the kept configuration, so that a controller beside a bench works without a host
    /// after a restart. Keeps the requirements of the installed packages.
    ///
    /// A configuration with which [`MAX_FAULTED_STARTS`] starts in a row have faulted is set aside:
    /// it remains stored, and the controller waits for the host.
    pub fn restore<S: SampleSource>(
        &mut self,
        shared: &mut impl Mutex<T = SharedSession<S>>,
        platform: &impl Platform,
    ) {
        if let Some(guard) = &self.guard {
            let requirement = guard.requirement(0);
            shared.lock(|shared| shared.session.set_authentication(requirement));
        }
        let StartWatch { faulted: faulted_starts, .. } = platform.start_watch();
        let is_set_aside = faulted_starts >= MAX_FAULTED_STARTS;
        if !is_set_aside {
            // If this fails, the next update is refused.
            self.stores.keep_trust();
        }
        let Some(configuration) = self.stores.configuration() else { return };
        let kept = shared.lock(|shared| {
            let kept = if is_set_aside {
                KeptConfiguration::SetAside { faulted_starts }
            } else if shared.session.configure(&configuration).is_err() {
                KeptConfiguration::Refused
            } else {
                KeptConfiguration::Restored
            };
            shared.session.set_kept_configuration(kept);
            if kept == KeptConfiguration::Restored {
                shared.rewire();
            }
            kept
        });
        if kept != KeptConfiguration::Restored {
            return;
        }
        platform.set_start_watch(StartWatch { faulted: faulted_starts, is_watched: true });
        if configuration.wiring.sample_at_start {
            // Refused on a board without sensors and for a period that is too short; idle ticks
            // then count.
            let _ = shared.lock(|shared| shared.session.start_sampling());
        }
    }

    /// Sends the hello frame of a start at every port, so that a host in the middle of a run
    /// notices the restart. Returns the frame's content.
    pub fn announce<A: Transport, B: Transport, S: SampleSource>(
        &self,
        ports: &mut Ports<A, B>,
        shared: &mut impl Mutex<T = SharedSession<S>>,
    ) -> Hello {
        let mut hello = shared.lock(|shared| shared.session.hello(0));
        self.authenticate(&mut hello);
        if self.pacing == Pacing::Timer {
            ports.end_frame();
        }
        send(&ToHost::Hello(hello), |frame| ports.send_everywhere(frame));
        hello
    }

    /// Runs one pass.
    ///
    /// # Errors
    ///
    /// The service must end.
    pub fn pass<A: Transport, B: Transport, S: SampleSource>(
        &mut self,
        ports: &mut Ports<A, B>,
        shared: &mut impl Mutex<T = SharedSession<S>>,
        platform: &mut impl Platform,
    ) -> Result<(), Stop> {
        let parties = platform.attendance().look(platform.uptime_us());
        platform.check_in(Party::Link);
        if platform.start_watch().is_watched && platform.uptime_us() >= FAULTLESS_US {
            platform.set_start_watch(StartWatch::default());
        }
        self.receive(ports, shared, platform, parties)?;
        self.replace_corrupted_models(shared);
        send_estimates(ports, shared);
        send_impacts(ports, shared);
        shared.lock(|shared| shared.session.set_line_report(ports.line()));
        self.send_telemetry(ports, shared, platform, parties);
        self.journal.look(shared, platform);
        let is_corrupted = self.background.step(self.pacing, shared, platform);
        if is_corrupted { Err(Stop::Corrupted) } else { Ok(()) }
    }

    /// Decodes received bytes until one request is served or the pass has read enough of them.
    fn receive<A: Transport, B: Transport, S: SampleSource>(
        &mut self,
        ports: &mut Ports<A, B>,
        shared: &mut impl Mutex<T = SharedSession<S>>,
        platform: &mut impl Platform,
        parties: [Presence; PARTIES.len()],
    ) -> Result<(), Stop> {
        for _ in 0..MAX_BYTES_PER_PASS {
            let (port, message) = match ports.receive() {
                Event::Nothing => break,
                Event::Closed => return Err(Stop::Closed),
                Event::Byte => continue,
                Event::Message(port, message) => (port, message),
            };
            let reply = match message {
                Ok(ToController::Sensor(frame, status)) if self.pacing == Pacing::Timer => {
                    shared.lock(|shared| shared.queue_sample(frame, status));
                    continue;
                }
                Ok(ToController::Sensor(frame, status)) => {
                    estimate_now(ports, shared, platform, &frame, status)
                }
                message => Some(self.serve(message, shared, platform, parties)),
            };
            // The impacts of a run that has just ended come before the answer.
            send_estimates(ports, shared);
            send_impacts(ports, shared);
            if let Some(reply) = reply
                && !send(&reply, |frame| ports.send(port, frame, Purpose::Reply))
            {
                shared.lock(|shared| shared.session.count_dropped_answer());
            }
            break;
        }
        Ok(())
    }

    /// Serves one message that is not a sample.
    fn serve<S: SampleSource>(
        &mut self,
        message: Result<ToController, FrameError>,
        shared: &mut impl Mutex<T = SharedSession<S>>,
        platform: &impl Platform,
        parties: [Presence; PARTIES.len()],
    ) -> ToHost {
        match message {
            Ok(ToController::Update(request)) => self.update(&request, shared, platform),
            Ok(message) => {
                if let Some(guard) = &self.guard
                    && let Err((id, reason)) = guard.admit(&message)
                {
                    let refused = shared.lock(|shared| shared.session.refuse(id, reason));
                    return ToHost::Acknowledged(refused);
                }
                self.update_status(shared, platform, parties);
                self.save_configuration(&message, shared);
                let mut reply = shared.lock(|shared| {
                    let reply = shared.session.handle(&message, &mut NoTicks);
                    shared.rewire();
                    reply
                });
                watch_after(&reply, platform);
                self.note_permission(&message, &reply);
                if let ToHost::Hello(hello) = &mut reply {
                    self.authenticate(hello);
                }
                reply
            }
            Err(error) => shared.lock(|shared| shared.session.bad_frame(error)),
        }
    }

    /// Serves a request about models. The session switches to new networks between two samples; the
    /// work before that runs while estimates continue.
    fn update<S: SampleSource>(
        &mut self,
        request: &UpdateRequest,
        shared: &mut impl Mutex<T = SharedSession<S>>,
        platform: &impl Platform,
    ) -> ToHost {
        let is_estimating = shared.lock(|shared| shared.session.state() != State::Waiting);
        if self.guard.as_ref().is_some_and(|guard| !guard.permits(request)) {
            return ToHost::Update(UpdateAnswer::Refused(UpdateRefusal::NotPermitted));
        }
        let served = self.stores.serve(request, is_estimating);
        if let UpdateAnswer::Refused(_) = served.answer {
            platform.log(&LogEvent::RefusedUpdate(self.stores.packages.status().refused));
        }
        if let (UpdateRequest::Finish, Some(guard)) = (request, &mut self.guard)
            && has_ended(&served.answer)
        {
            guard.end_permission();
        }
        if let Some(models) = served.models {
            shared.lock(|shared| shared.session.switch_models(models));
        }
        ToHost::Update(served.answer)
    }

    /// Sets the requirement for commands and its tag. Takes too long for the session's lock.
    fn authenticate(&self, hello: &mut Hello) {
        if let Some(guard) = &self.guard {
            hello.authentication = guard.requirement(hello.last_command);
        }
    }

    /// Notes the package that a command has permitted. An update with another one is given up.
    fn note_permission(&mut self, message: &ToController, reply: &ToHost) {
        if let (Some(guard), ToController::Authenticated(numbered, _)) = (&mut self.guard, message)
            && let Command::PermitUpdate(package) = numbered.command
            && let ToHost::Acknowledged(Acknowledgement { outcome: Ok(_), .. }) = reply
            && guard.note_permission(numbered.id, package)
        {
            let _ = self.stores.serve(&UpdateRequest::Abort, false);
        }
    }

    /// Copies watchdog check-ins, the state of the model store and the last sample into the
    /// session's report.
    fn update_status<S: SampleSource>(
        &self,
        shared: &mut impl Mutex<T = SharedSession<S>>,
        platform: &impl Platform,
        parties: [Presence; PARTIES.len()],
    ) {
        let (uptime_us, models) = (platform.uptime_us(), self.stores.packages.status());
        shared.lock(|shared| {
            let (sample, sampling) = (shared.latest_sample(), shared.sampling());
            shared.session.update_status(Status { uptime_us, parties, models, sample, sampling });
        });
    }

    /// Saves the configuration if a message requests it, before the session answers the message.
    fn save_configuration<S: SampleSource>(
        &mut self,
        message: &ToController,
        shared: &mut impl Mutex<T = SharedSession<S>>,
    ) {
        if let Some(configuration) = shared.lock(|shared| shared.session.configuration_to_save(message)) {
            let is_saved = self.stores.keep(&configuration).is_ok();
            shared.lock(|shared| shared.session.set_saved(is_saved));
        }
    }

    /// Switches to intact networks if the session has found those in use corrupted.
    fn replace_corrupted_models<S: SampleSource>(&mut self, shared: &mut impl Mutex<T = SharedSession<S>>) {
        if shared.lock(|shared| shared.session.take_model_corruption()) {
            let models = self.stores.packages.replace_corrupted();
            shared.lock(|shared| shared.session.switch_models(models));
        }
    }

    /// Sends the frame of slow telemetry that is due, if any.
    fn send_telemetry<A: Transport, B: Transport, S: SampleSource>(
        &self,
        ports: &mut Ports<A, B>,
        shared: &mut impl Mutex<T = SharedSession<S>>,
        platform: &impl Platform,
        parties: [Presence; PARTIES.len()],
    ) {
        if !shared.lock(|shared| shared.session.is_telemetry_due()) {
            return;
        }
        self.update_status(shared, platform, parties);
        if let Some(report) = shared.lock(|shared| shared.session.take_telemetry())
            && !send(&report, |frame| ports.send_to_host(frame))
        {
            shared.lock(|shared| shared.session.count_dropped_answer());
        }
    }
}

/// Decides by the answer to [`UpdateRequest::Finish`] whether the update has ended: the package is
/// installed, or its slot has been erased.
const fn has_ended(answer: &UpdateAnswer) -> bool {
    use UpdateRefusal::{Estimating, NotBegun, Unfinished};
    !matches!(answer, UpdateAnswer::Refused(Unfinished { .. } | NotBegun | Estimating))
}

/// Adapts the watch over this start to a reply: with another configuration than the kept one a
/// fault does not count, and a newly kept one starts from none.
fn watch_after(reply: &ToHost, platform: &impl Platform) {
    let ToHost::Acknowledged(Acknowledgement { outcome: Ok(answer), .. }) = reply else { return };
    match answer {
        Answer::Kept => platform.set_start_watch(StartWatch::default()),
        Answer::Configured(_) => {
            platform.set_start_watch(StartWatch { is_watched: false, ..platform.start_watch() });
        }
        _ => {}
    }
}

/// Estimates a sample in lockstep and sends the estimate. Returns the reply if the session refuses.
fn estimate_now<A: Transport, B: Transport, S: SampleSource>(
    ports: &mut Ports<A, B>,
    shared: &mut impl Mutex<T = SharedSession<S>>,
    platform: &mut impl Platform,
    frame: &SensorFrame,
    status: SensorStatus,
) -> Option<ToHost> {
    match shared.lock(|shared| shared.session.tick(frame, status, platform.ticks())) {
        Ok(estimate) => {
            platform.check_in(Party::Sampling);
            platform.check_in(Party::Inference);
            if !ports.send_to_host(&estimate) {
                shared.lock(|shared| shared.session.count_dropped_estimate());
            }
            None
        }
        Err(refusal) => Some(refusal),
    }
}
