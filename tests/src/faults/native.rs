//! A sensor fault on the controller's code in this process: the messages of the emulated controller
//! in a fraction of the time.

use super::CampaignError;
use super::attempt::messages;
use super::classify::{Outcome, classify};
use super::emulator::PumpEnd;
use super::plan::Fault;
use super::scenario::Scenario;
use super::streams::disturbed;
use controller::{Identity, NoTicks, Session};
use link::{BuildId, ClockSource, Target, ToController, ToHost};

/// Injects a sensor fault and classifies it.
pub fn attempt(scenario: &Scenario, fault: &Fault) -> Result<Outcome, CampaignError> {
    let build_id = BuildId::new(env!("CARGO_PKG_VERSION"));
    let identity = Identity { build_id, target: Target::Native, clock: ClockSource::Host, core_hz: 0 };
    let mut session = Session::new(identity);
    let (configure, ending) = messages(scenario);
    let samples = disturbed(fault, &scenario.frames);
    let samples = samples.into_iter().map(|(frame, status)| ToController::Sensor(frame, status));
    let received: Vec<Result<ToHost, _>> = [configure]
        .into_iter()
        .chain(samples)
        .chain(ending)
        .map(|message| Ok(session.handle(&message, &mut NoTicks)))
        .collect();
    Ok(classify(fault, scenario, &received, PumpEnd::Arrived))
}
