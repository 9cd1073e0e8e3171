//! The link service: everything that the controller does outside the timer tick.
//!
//! One pass of the service's loop ([`LinkService::pass`]) receives and decodes frames, serves at
//! most one request, replaces corrupted models, sends the estimates and the telemetry that are due,
//! and runs one step of the background checks. The number of bytes and of replies per pass is
//! bounded, so that a flood of requests does not delay the estimates.
//!
//! The service is generic over the transport ([`Transport`]), the board ([`Platform`]) and the lock
//! of the state that the tick shares ([`Exchange`]). The host tests it with a scripted transport.

mod background;
mod exchange;
mod transport;

#[cfg(test)]
mod tests;

use link::start::{PARTIES, Presence};
use link::track::SensorStatus;
use link::update::{UpdateAnswer, UpdateRequest};
use link::{
    CONFIGURATION_VERSION, FrameError, Hello, MAX_FRAME, SensorFrame, State, ToController, ToHost, encode,
};
use rtic_core::Mutex;

pub use crate::session::LineReport;
use crate::session::{NoTicks, Status};
use crate::store::{Keeper, SlotMemory, Store};
use crate::supervisor::Party;
pub use background::{Background, Platform};
pub use exchange::{Exchange, SampleSource, Tick};
use transport::Event;
pub use transport::{Ports, Purpose, Received, Transport, Unconnected};

/// Maximum number of received bytes that one pass reads.
const MAX_BYTES_PER_PASS: usize = 256;

/// Event that starts the estimate of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pacing {
    /// The timer: samples wait for its tick.
    Timer,
    /// The host: the service estimates each sample when it arrives, so that the instruction count
    /// of a tick repeats exactly. Only the emulator does this.
    Lockstep,
}

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
    store: Store<M>,
    keeper: Keeper<M>,
    background: Background,
}

impl<M: SlotMemory> LinkService<M> {
    /// Creates the service.
    pub const fn new(pacing: Pacing, store: Store<M>, keeper: Keeper<M>, background: Background) -> Self {
        Self { pacing, store, keeper, background }
    }

    /// Restores the saved configuration, so that a controller beside a bench works without a host
    /// after a restart. A refusal means that another build saved the configuration.
    pub fn restore<S: SampleSource>(&mut self, exchange: &mut impl Mutex<T = Exchange<S>>) {
        let Some(configuration) = self.keeper.value(CONFIGURATION_VERSION.into()) else { return };
        exchange.lock(|exchange| {
            let _ = exchange.session.configure(&configuration);
            exchange.rewire();
            if configuration.wiring.sample_at_start {
                // Refused on a board without sensors and for a bench with another sample period.
                let _ = exchange.session.start_sampling();
            }
        });
    }

    /// Sends the hello frame of a start at every port, so that a host in the middle of a run
    /// notices the restart. Returns the frame's content.
    pub fn announce<A: Transport, B: Transport, S: SampleSource>(
        &self,
        ports: &mut Ports<A, B>,
        exchange: &mut impl Mutex<T = Exchange<S>>,
    ) -> Hello {
        let hello = exchange.lock(|exchange| exchange.session.hello(0));
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
        exchange: &mut impl Mutex<T = Exchange<S>>,
        platform: &mut impl Platform,
    ) -> Result<(), Stop> {
        let parties = platform.attendance().look(platform.uptime_us());
        platform.check_in(Party::Link);
        self.receive(ports, exchange, platform, parties)?;
        self.replace_corrupted_models(exchange);
        send_estimates(ports, exchange);
        exchange.lock(|exchange| exchange.session.set_line_report(ports.line()));
        self.send_telemetry(ports, exchange, platform, parties);
        self.background.step(self.pacing, exchange, platform)
    }

    /// Decodes received bytes until one request is served or the pass has read enough of them.
    fn receive<A: Transport, B: Transport, S: SampleSource>(
        &mut self,
        ports: &mut Ports<A, B>,
        exchange: &mut impl Mutex<T = Exchange<S>>,
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
                    exchange.lock(|exchange| exchange.queue_sample(frame, status));
                    continue;
                }
                Ok(ToController::Sensor(frame, status)) => {
                    estimate_now(ports, exchange, platform, &frame, status)
                }
                message => Some(self.serve(message, exchange, platform, parties)),
            };
            if let Some(reply) = reply
                && !send(&reply, |frame| ports.send(port, frame, Purpose::Reply))
            {
                exchange.lock(|exchange| exchange.session.count_dropped_answer());
            }
            break;
        }
        Ok(())
    }

    /// Serves one message that is not a sample.
    fn serve<S: SampleSource>(
        &mut self,
        message: Result<ToController, FrameError>,
        exchange: &mut impl Mutex<T = Exchange<S>>,
        platform: &impl Platform,
        parties: [Presence; PARTIES.len()],
    ) -> ToHost {
        match message {
            Ok(ToController::Update(request)) => self.update(&request, exchange, platform),
            Ok(message) => {
                self.update_status(exchange, platform, parties);
                self.save_configuration(&message, exchange);
                exchange.lock(|exchange| {
                    let reply = exchange.session.handle(&message, &mut NoTicks);
                    exchange.rewire();
                    reply
                })
            }
            Err(error) => exchange.lock(|exchange| exchange.session.bad_frame(error)),
        }
    }

    /// Serves a request about models. The session switches to new networks between two samples; the
    /// work before that runs while estimates continue.
    fn update<S: SampleSource>(
        &mut self,
        request: &UpdateRequest,
        exchange: &mut impl Mutex<T = Exchange<S>>,
        platform: &impl Platform,
    ) -> ToHost {
        let is_estimating = exchange.lock(|exchange| exchange.session.state() != State::Waiting);
        let served = self.store.serve(request, is_estimating);
        if let UpdateAnswer::Refused(_) = served.answer {
            platform.log_refused_update(self.store.status().refused);
        }
        if let Some(models) = served.models {
            exchange.lock(|exchange| exchange.session.switch_models(models));
        }
        ToHost::Update(served.answer)
    }

    /// Copies watchdog check-ins, the state of the model store and the last sample into the
    /// session's report.
    fn update_status<S: SampleSource>(
        &self,
        exchange: &mut impl Mutex<T = Exchange<S>>,
        platform: &impl Platform,
        parties: [Presence; PARTIES.len()],
    ) {
        let (uptime_us, models) = (platform.uptime_us(), self.store.status());
        exchange.lock(|exchange| {
            let sample = exchange.latest_sample();
            exchange.session.update_status(Status { uptime_us, parties, models, sample });
        });
    }

    /// Saves the configuration if a message requests it, before the session answers the message.
    fn save_configuration<S: SampleSource>(
        &mut self,
        message: &ToController,
        exchange: &mut impl Mutex<T = Exchange<S>>,
    ) {
        if let Some(configuration) = exchange.lock(|exchange| exchange.session.configuration_to_save(message))
        {
            let is_saved = self.keeper.keep(CONFIGURATION_VERSION.into(), &configuration).is_ok();
            exchange.lock(|exchange| exchange.session.set_saved(is_saved));
        }
    }

    /// Switches to intact networks if the session has found those in use corrupted.
    fn replace_corrupted_models<S: SampleSource>(&mut self, exchange: &mut impl Mutex<T = Exchange<S>>) {
        if exchange.lock(|exchange| exchange.session.take_model_corruption()) {
            let models = self.store.replace_corrupted();
            exchange.lock(|exchange| exchange.session.switch_models(models));
        }
    }

    /// Sends the frame of slow telemetry that is due, if any.
    fn send_telemetry<A: Transport, B: Transport, S: SampleSource>(
        &self,
        ports: &mut Ports<A, B>,
        exchange: &mut impl Mutex<T = Exchange<S>>,
        platform: &impl Platform,
        parties: [Presence; PARTIES.len()],
    ) {
        if !exchange.lock(|exchange| exchange.session.is_telemetry_due()) {
            return;
        }
        self.update_status(exchange, platform, parties);
        if let Some(report) = exchange.lock(|exchange| exchange.session.take_telemetry())
            && !send(&report, |frame| ports.send_to_host(frame))
        {
            exchange.lock(|exchange| exchange.session.count_dropped_answer());
        }
    }
}

/// Estimates a sample in lockstep and sends the estimate. Returns the reply if the session refuses.
fn estimate_now<A: Transport, B: Transport, S: SampleSource>(
    ports: &mut Ports<A, B>,
    exchange: &mut impl Mutex<T = Exchange<S>>,
    platform: &mut impl Platform,
    frame: &SensorFrame,
    status: SensorStatus,
) -> Option<ToHost> {
    match exchange.lock(|exchange| exchange.session.tick(frame, status, platform.ticks())) {
        Ok(estimate) => {
            platform.check_in(Party::Sampling);
            platform.check_in(Party::Inference);
            if !ports.send_to_host(&estimate) {
                exchange.lock(|exchange| exchange.session.count_dropped_estimate());
            }
            None
        }
        Err(refusal) => Some(refusal),
    }
}

/// Sends the estimates that the tick has queued.
fn send_estimates<A: Transport, B: Transport, S: SampleSource>(
    ports: &mut Ports<A, B>,
    exchange: &mut impl Mutex<T = Exchange<S>>,
) {
    while let Some(estimate) = exchange.lock(Exchange::next_estimate) {
        if !ports.send_to_host(&estimate) {
            exchange.lock(|exchange| exchange.session.count_dropped_estimate());
        }
    }
}

/// Encodes a message and passes it to a transport. Returns false if the transport does not take it.
fn send(message: &ToHost, write: impl FnOnce(&[u8]) -> bool) -> bool {
    let mut buffer = [0; MAX_FRAME];
    encode(message, &mut buffer).is_ok_and(write)
}
