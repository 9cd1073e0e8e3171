//! A fault of a sensor on the controller's code in this process: what the emulated controller would say, in a fraction of the time.

use super::CampaignError;
use super::attempt::messages;
use super::emulator::Pumped;
use super::judge::{Outcome, judge};
use super::plan::Fault;
use super::stage::Stage;
use super::streams::disturbed;
use firmware::{Identity, NoTicks, Session};
use link::{BuildId, ClockSource, Target, ToController, ToHost};

/// Carries a fault of a sensor out and classes it.
pub fn attempt(stage: &Stage, fault: &Fault) -> Result<Outcome, CampaignError> {
    let build_id = BuildId::new(env!("CARGO_PKG_VERSION"));
    let identity = Identity { build_id, target: Target::Native, clock: ClockSource::Host, core_hz: 0 };
    let mut session = Session::new(identity);
    let (configure, ending) = messages(stage);
    let samples = disturbed(fault, &stage.frames);
    let samples = samples.into_iter().map(|(frame, status)| ToController::Sensor(frame, status));
    let said: Vec<Result<ToHost, _>> = [configure]
        .into_iter()
        .chain(samples)
        .chain(ending)
        .map(|message| Ok(session.handle(&message, &mut NoTicks)))
        .collect();
    Ok(judge(fault, stage, &said, Pumped::Come))
}
